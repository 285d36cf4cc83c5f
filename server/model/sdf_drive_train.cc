// SPDX-License-Identifier: MIT
// Reads `<coopdyn:drivetrain>` in a <joint>.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/model/sdf_parts.h"

namespace coopdyn {

namespace {

constexpr double kMostOfTrain = 1e9;

PwmRow ReadPwm(const tinyxml2::XMLElement& element, const std::string& file, Diagnostics& diagnostics) {
  XmlAttributes attributes(element, file, diagnostics);
  for (const char* needed : {"duty", "no_load_speed_rad_s", "stall_torque_nm"}) attributes.Require(needed);
  PwmRow row;
  row.duty = attributes.Number("duty", 0, 1).value_or(1);
  row.no_load_speed_rad_s = attributes.Number("no_load_speed_rad_s", 1e-6, 1e6).value_or(1);
  row.stall_torque_nm = attributes.Number("stall_torque_nm", 0, 1e6).value_or(1);
  row.stall_current_a = attributes.Number("stall_current_a", 0, 1e6).value_or(0);
  attributes.Finish();
  if (!(row.duty > 0)) attributes.Error("'duty' must be above 0: at 0 the motor brakes");
  return row;
}

/// Completes the motor's values from its rows.
void FinishMotor(XmlAttributes& attributes, DriveTrainModel& train) {
  const std::optional<double> constant_nm_a = attributes.Number("torque_constant_nm_a", 1e-9, 1e6);
  const std::optional<double> brake = attributes.Number("brake_nms_rad", 0, kMostOfTrain);
  if (train.pwm.empty()) return;
  for (PwmRow& row : train.pwm) {
    if (constant_nm_a && row.stall_current_a == 0) row.stall_current_a = row.stall_torque_nm / *constant_nm_a;
  }
  const PwmRow& full = train.pwm.back();
  train.brake_nms_rad = brake.value_or(full.stall_torque_nm / full.no_load_speed_rad_s);
}

}  // namespace

void ReadDriveTrain(const tinyxml2::XMLElement& element, const std::string& file, JointModel& joint,
                    Diagnostics& diagnostics) {
  XmlAttributes attributes(element, file, diagnostics);
  DriveTrainModel train;
  for (const tinyxml2::XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "coopdyn:pwm") {
      train.pwm.push_back(ReadPwm(*child, file, diagnostics));
      const std::size_t count = train.pwm.size();
      if (count > 1 && !(train.pwm[count - 2].duty < train.pwm[count - 1].duty)) {
        diagnostics.Error({file, child->GetLineNum()},
                          "<coopdyn:pwm>: each row needs a larger 'duty' than the one before");
      }
    } else {
      diagnostics.Error({file, child->GetLineNum()}, std::string("unknown element <") + child->Name() +
                                                         ">: <coopdyn:drivetrain> has rows <coopdyn:pwm>");
    }
  }
  const auto number = [&attributes](const char* name, double least, double most, double& value) {
    value = attributes.Number(name, least, most).value_or(value);
  };
  constexpr double kTiny = 1e-12;
  double backlash_deg = 0;
  number("ratio", 1e-3, 1e6, train.ratio);
  number("efficiency", 0.01, 1, train.efficiency);
  number("rotor_inertia_kg_m2", kTiny, 1e6, train.rotor_inertia_kg_m2);
  number("backlash_deg", 0, 360, backlash_deg);
  number("stiffness_nm_rad", kTiny, kMostOfTrain, train.stiffness_nm_rad);
  number("damping_nms_rad", 0, kMostOfTrain, train.damping_nms_rad);
  number("preload_nm", 0, kMostOfTrain, train.preload_nm);
  number("dynamic_friction_nm", 0, kMostOfTrain, train.dynamic_friction_nm);
  train.static_friction_nm = train.dynamic_friction_nm;
  number("static_friction_nm", 0, kMostOfTrain, train.static_friction_nm);
  number("stiction_speed_rad_s", 0, kMostOfTrain, train.stiction_speed_rad_s);
  FinishMotor(attributes, train);
  attributes.Finish();
  train.backlash_rad = backlash_deg * std::numbers::pi / 180;
  const std::string of = " of joint '" + joint.name + "'";
  if (joint.kind != JointModel::Kind::kHinge)
    attributes.Error("only a revolute or continuous joint has one, and '" + joint.name + "' is none");
  if (train.pwm.empty())
    attributes.Error("the motor" + of +
                     " needs a row, for example <coopdyn:pwm duty=\"1\" "
                     "no_load_speed_rad_s=\"50\" stall_torque_nm=\"0.2\"/>");
  if (train.is_rigid() && (train.damping_nms_rad > 0 || train.preload_nm > 0))
    attributes.Error("damping_nms_rad and preload_nm are those of a spring: write stiffness_nm_rad, too");
  if (train.static_friction_nm < train.dynamic_friction_nm)
    attributes.Error("static_friction_nm must be at least dynamic_friction_nm");
  if (joint.friction > 0)
    attributes.Error("write dynamic_friction_nm here instead of <friction> in <dynamics>" + of);
  if (joint.drive_train) attributes.Error("it stands twice in joint '" + joint.name + "': keep one");
  if (!train.pwm.empty()) {
    const PwmRow& full = train.pwm.back();
    if (!std::isfinite(joint.max_effort)) joint.max_effort = train.ratio * full.stall_torque_nm;
    if (!std::isfinite(joint.max_velocity)) joint.max_velocity = full.no_load_speed_rad_s / train.ratio;
  }
  joint.drive_train = std::move(train);
}

}  // namespace coopdyn
