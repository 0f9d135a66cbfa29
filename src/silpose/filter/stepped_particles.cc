#include "silpose/filter/stepped_particles.h"

namespace silpose {

FilterReport SteppedParticles::coast(const Propagate& propagate) {
  FilterReport report;
  propagate(now_.particles.states, stream_of(now_.step++));
  report.effective_sample_size = effective_sample_size(now_.particles.weights());
  return report;
}

}  // namespace silpose
