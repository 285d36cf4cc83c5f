// SPDX-License-Identifier: MIT
#include "server/mjcf/source.h"

#include <algorithm>
#include <cmath>

#include "server/mjcf/sdf_text.h"

namespace coopdyn::mjcf {

namespace {

double Farthest(const mjtNum* range) {
  return std::max(std::abs(range[0]), std::abs(range[1]));
}

bool IsScalar(const mjModel& model, int joint) {
  return model.jnt_type[joint] == mjJNT_HINGE || model.jnt_type[joint] == mjJNT_SLIDE;
}

}  // namespace

bool IsMuscle(const mjModel& model, int index) {
  return model.actuator_gaintype[index] == mjGAIN_MUSCLE || model.actuator_dyntype[index] == mjDYN_MUSCLE;
}

double ForceLimit(const mjModel& m, int i) {
  if (m.actuator_forcelimited[i]) return Farthest(m.actuator_forcerange + 2 * i);
  if (!m.actuator_ctrllimited[i] || m.actuator_gaintype[i] != mjGAIN_FIXED) return 0;
  const mjtNum* const range = m.actuator_ctrlrange + 2 * i;
  const double gain = std::abs(m.actuator_gainprm[mjNGAIN * i]);
  // The position error of a position servo is at most its range.
  const bool is_position =
      m.actuator_biastype[i] == mjBIAS_AFFINE && m.actuator_biasprm[mjNBIAS * i + 1] != 0;
  return gain * (is_position ? range[1] - range[0] : Farthest(range));
}

Source::Source(const Loaded& loaded, Words& words)
    : loaded_(loaded), model_(*loaded.model), words_(words), home_(mj_name2id(&model_, mjOBJ_KEY, "home")) {
  mjData* const data = mj_makeData(&model_);
  mj_kinematics(&model_, data);
  FindFloor();
  for (int body = 0; body < model_.nbody; ++body) {
    X_WB_.push_back(ToPose(data->xpos + 3 * body, data->xquat + 4 * body));
    X_WB_.back().p.z() -= floor_z_m_;
  }
  mj_deleteData(data);
  ReadActuators();
  ReadMasks();
}

void Source::FindFloor() {
  bool has_floor = false;
  for (int i = 0; i < model_.body_geomnum[0]; ++i) {
    const int geom = model_.body_geomadr[0] + i;
    constexpr double kLevel = 1 - 1e-6;
    const Vector3 up = ToPose(model_.geom_pos + 3 * geom, model_.geom_quat + 4 * geom).q * Vector3::UnitZ();
    if (model_.geom_type[geom] != mjGEOM_PLANE || up.z() < kLevel) continue;
    const double z_m = model_.geom_pos[3 * geom + 2];
    floor_z_m_ = has_floor ? std::max(floor_z_m_, z_m) : z_m;
    has_floor = true;
  }
  if (floor_z_m_ != 0)
    words_.Say(
        "the floor is at z = " + Number(floor_z_m_) + " m: here it is at 0, and all else as far above it",
        false);
}

void Source::ReadMasks() {
  const mjModel& m = model_;
  const auto n = static_cast<std::size_t>(m.ngeom);
  const auto mask = [](const int* masks, std::size_t geom) { return static_cast<unsigned>(masks[geom]); };
  const auto fit = [&](std::size_t a, std::size_t b) {
    return (mask(m.geom_contype, a) & mask(m.geom_conaffinity, b)) != 0 ||
           (mask(m.geom_contype, b) & mask(m.geom_conaffinity, a)) != 0;
  };
  const auto tree = [&](std::size_t geom) { return m.body_rootid[m.geom_bodyid[geom]]; };
  const auto moves = [&](std::size_t geom) { return m.body_weldid[m.geom_bodyid[geom]] != 0; };
  bool any_moves = false, has_plane = false;
  for (std::size_t geom = 0; geom < n; ++geom) {
    any_moves = any_moves || moves(geom);
    has_plane = has_plane || m.geom_type[geom] == mjGEOM_PLANE;
  }
  collides_.assign(n, 0);
  for (std::size_t a = 0; a < n; ++a) {
    const bool is_any = mask(m.geom_contype, a) != 0 || mask(m.geom_conaffinity, a) != 0;
    const bool meets_all = !any_moves || (!has_plane && moves(a));
    collides_[a] |= static_cast<char>(is_any && meets_all);
    for (std::size_t b = 0; b < a; ++b) {
      if (tree(a) == tree(b) || !(moves(a) || moves(b)) || !fit(a, b)) continue;
      collides_[a] = collides_[b] = 1;
    }
  }
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (collides_[a] == 0 || collides_[b] == 0 || tree(a) == tree(b) || !(moves(a) || moves(b)) ||
          fit(a, b))
        continue;
      return words_.Say(
          "contype and conaffinity let some geoms through each other: here these touch, as both "
          "touch something",
          false);
    }
  }
}

std::string PlainName(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ' || c == ':') c = '_';
  }
  return name;
}

std::string Source::NameOf(mjtObj type, int id, const std::string& otherwise) const {
  const char* const given = mj_id2name(&model_, type, id);
  std::string name = PlainName(given == nullptr ? "" : given);
  if (name.empty()) return otherwise + "_" + std::to_string(id);
  if (name.starts_with("__")) name = otherwise + name;  // SDF reserves these
  return name == "world" ? otherwise + "_world" : name;
}

double Source::Start(int joint) const {
  if (home_ < 0 || !IsScalar(model_, joint)) return 0;
  const int at = model_.jnt_qposadr[joint];
  double value = model_.key_qpos[model_.nq * home_ + at];
  if (model_.jnt_limited[joint])
    value = std::clamp(value, model_.jnt_range[2 * joint], model_.jnt_range[2 * joint + 1]);
  return value - model_.qpos0[at];
}

void Source::ReadActuators() {
  const mjModel& m = model_;
  efforts_.resize(static_cast<std::size_t>(m.njnt));
  speeds_.resize(static_cast<std::size_t>(m.njnt));
  constexpr double kUsual = 100;  // N m or N, as for motors of Gazebo plugins without a limit
  const auto add = [&](int joint, int actuator, double gear) {
    if (!IsScalar(m, joint)) return words_.Say("an actuator of a ball or free joint is left out");
    gear = std::abs(gear);
    const double limit = ForceLimit(m, actuator);
    if (limit == 0)
      words_.Say("an actuator has neither forcerange nor ctrlrange: its motor has " + Number(kUsual) +
                 " N m, or N, at most");
    efforts_[static_cast<std::size_t>(joint)] += limit == 0 ? kUsual : limit * gear;
    const bool is_velocity = m.actuator_biastype[actuator] == mjBIAS_AFFINE &&
                             m.actuator_biasprm[mjNBIAS * actuator + 1] == 0 &&
                             m.actuator_biasprm[mjNBIAS * actuator + 2] != 0;
    if (is_velocity && m.actuator_ctrllimited[actuator] && gear > 0)
      speeds_[static_cast<std::size_t>(joint)] = Farthest(m.actuator_ctrlrange + 2 * actuator) / gear;
  };
  for (int i = 0; i < m.nu; ++i) {
    const int target = m.actuator_trnid[2 * i];
    const double gear = m.actuator_gear[6 * i];
    if (IsMuscle(m, i)) {
      words_.Say("a muscle is left out");
    } else if (m.actuator_trntype[i] == mjTRN_JOINT || m.actuator_trntype[i] == mjTRN_JOINTINPARENT) {
      add(target, i, gear);
    } else if (m.actuator_trntype[i] == mjTRN_TENDON) {
      const int start = m.tendon_adr[target];
      for (int k = start; k < start + m.tendon_num[target]; ++k) {
        if (m.wrap_type[k] == mjWRAP_JOINT)
          add(m.wrap_objid[k], i, gear * m.wrap_prm[k]);
        else if (k == start)
          words_.Say("an actuator that pulls a spatial tendon is left out");
      }
    } else if (m.actuator_trntype[i] != mjTRN_SITE) {
      words_.Say("an actuator whose transmission is not a joint, tendon or site is left out");
    }
  }
  // The joint's own limit, which load.cc keeps as user data.
  for (int j = 0; j < m.njnt && loaded_.has_joint_limits; ++j) {
    const double most = Farthest(m.jnt_user + m.nuser_jnt * j);
    double& effort = efforts_[static_cast<std::size_t>(j)];
    if (most > 0 && effort > 0) effort = std::min(effort, most);
  }
}

}  // namespace coopdyn::mjcf
