// Option files of --config.
#include "apps/silpose/option_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace silpose;
  CLI::App app{"", "fuzz"};
  int number = 0;
  std::string text;
  std::vector<double> list;
  bool flag = false;
  app.add_option("--number", number)->check(CLI::Range(0, 9));
  app.add_option("--text", text);
  app.add_option("--list", list);
  app.add_flag("--flag", flag);
  try {
    (void)app::apply_option_file(fuzz::file_with(fuzz::text_of(data, size)), app);
    (void)app::option_lines(app, {});
  } catch (const CLI::Error&) {  // values out of range
  }
  return 0;
}
