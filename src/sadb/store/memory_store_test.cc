// The contract of blackboard.h over MemoryStore; and that it shares payloads.
#include "sadb/store/memory_store.h"

#include "sadb/board/blackboard_contract_for_test.h"
#include "sadb/board/blackboard_streams_for_test.h"

namespace sadb {
namespace {

const MakeBoard kMakeMemoryStore = [] { return std::make_unique<MemoryStore>(); };

INSTANTIATE_TEST_SUITE_P(Memory, BlackboardContract, testing::Values(kMakeMemoryStore));
INSTANTIATE_TEST_SUITE_P(Memory, BlackboardStreams, testing::Values(kMakeMemoryStore));

TEST(MemoryStore, NeverCopiesAPayload) {
  MemoryStore board;
  const auto subscription = board.watch("", {}).value();
  const Shared<silpose::Mask> mask = silpose::mask_from_text("#.");
  const auto is_shared = [&](const Value& value) { return &*std::get<Shared<silpose::Mask>>(value) == &*mask; };
  ASSERT_TRUE(board.put("mask", 1, mask));
  EXPECT_TRUE(is_shared(board.get("mask", 1, {Method::kBefore}).value().value));
  EXPECT_TRUE(is_shared(board.snapshot(1, {{"mask", {Method::kHold}}}).value()[0].value().value));
  EXPECT_TRUE(is_shared(read_range(board, "mask").value()[0].value));
  EXPECT_TRUE(is_shared(poll(*subscription).entries[0].value));
}

}  // namespace
}  // namespace sadb
