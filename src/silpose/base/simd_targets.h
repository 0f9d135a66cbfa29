// For tests: the same code under every instruction set that it was built for and that this processor has.
// Threads: no other thread may draw meanwhile.
#pragma once

#include <hwy/highway.h>

namespace silpose {

// Calls visit(name) once per instruction set, which is used meanwhile; the processor's best is used again afterwards.
template <class Visit>
void for_each_simd_target(Visit&& visit) {
  struct BestAgain {
    ~BestAgain() {
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
  } best_again;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    visit(hwy::TargetName(target));
  }
}

}  // namespace silpose
