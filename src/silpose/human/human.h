// The human of the thesis: 20 joints, 37 DOF (Table 2.1), built from the MakeHuman data by phenotype.
// Threads: functions without state; MakeHumanData is constant after loading.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"

namespace silpose {

// Who the body is of. An unset height follows the sliders' average for age and sex, an unset weight the body mass index
// of adults (ncdrisc2016).
struct Phenotype {
  double age_years = 25;            // 18 to 90
  double sex = 0.5;                 // 0 male, 1 female; 0.5 in between
  std::optional<double> height_m;   // stature
  std::optional<double> weight_kg;  // volume x 980 kg/m3
  std::optional<double> muscle;     // 0 to 1; unset: 0.5, less the further the weight is from average
};

// "human", "human:age=30,sex=f,height=1.62,weight=58,muscle=0.6". sex: f, m or 0..1. dof= is left to the caller.
// Errors: unknown or repeated key, not a number, out of range; names the key.
Result<Phenotype> parse_phenotype(const std::string& text);

// How far the stature of such people is from the body's, one standard deviation, relative: 0 where the height is given.
// Source: adults, references.bib: stoudt1965.
double stature_deviation(const Phenotype& phenotype);

class MakeHumanData {
 public:
  // Reads base mesh, rig, weights and the adult macro targets from a folder made by scripts/fetch-body-data.
  // Errors: missing file (says which script fetches it), content of another hash, malformed.
  static Result<MakeHumanData> load(const std::filesystem::path& directory);
  MakeHumanData(MakeHumanData&&) noexcept;
  MakeHumanData& operator=(MakeHumanData&&) noexcept;
  ~MakeHumanData();

 private:
  friend Result<BodyModel> build_human(const MakeHumanData&, const Phenotype&);
  MakeHumanData();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Errors: height or weight that the sliders cannot reach; names the reachable range.
Result<BodyModel> build_human(const MakeHumanData& data, const Phenotype& phenotype);

// Whether the joints of a body that build_human() made are where it would put them today: false for one that an earlier
// version built and wrote to a file.
[[nodiscard]] bool has_present_joint_places(const BodyModel& human);

// The 37-DOF skeleton with given joint positions in the zero pose [20], world coordinates, metres. Only differences of
// positions matter: the root's own place is the pose's root_tx, root_ty, root_tz.
// Source: thesis Table 2.1 (cormier2019); signs, orders and limits: docs/formats.md.
[[nodiscard]] Skeleton human_skeleton(std::span<const Eigen::Vector3d> joint_in_world);

}  // namespace silpose
