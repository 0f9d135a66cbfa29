// The levels of detail of a body by what they serve, in about so many vertices. `.body` files hold them, so that
// nothing is simplified at run time. Threads: constants.
#pragma once

#include <array>

namespace silpose {

inline constexpr int kRankingLevel = 800;    // starts and limbs are ranked, errors of the body are estimated [guess]
inline constexpr int kSamplingLevel = 2000;  // particles are weighed [measured: 0.986 of the full mesh's silhouettes]
inline constexpr int kTrackingLevel = 2500;  // poses are fitted [guess]
inline constexpr int kBodyFitLevel = 3000;   // bones and girths are fitted [measured: 0.992 of them]
// All that are kept: these, and steps between for level_of_detail() by overlap.
inline constexpr std::array kKeptLevels = {kRankingLevel,  1000,           1250,          1500,
                                           kSamplingLevel, kTrackingLevel, kBodyFitLevel, 5000};

}  // namespace silpose
