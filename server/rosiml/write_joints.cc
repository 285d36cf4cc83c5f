// SPDX-License-Identifier: MIT
#include "server/rosiml/write_joints.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "server/base/printable.h"

namespace coopdyn::rosiml {

namespace {

class JointWriter {
 public:
  JointWriter(const Movable& movable, const Model& model, const std::map<int, std::string>& links,
              const std::string& file, Names& names, WrittenModel& written, Diagnostics& diagnostics)
      : movable_(movable),
        model_(model),
        links_(links),
        file_(file),
        names_(names),
        written_(written),
        diagnostics_(diagnostics) {}

  JointNames Write() {
    WriteStill();
    for (std::size_t i = 0; i < model_.links.size(); ++i) WriteJoint(i);
    WriteDrive();
    for (std::size_t i = 0; i < movable_.muscles.size(); ++i) WriteMuscle(static_cast<int>(i));
    for (std::size_t i = 0; i < movable_.thrusters.size(); ++i) WriteThruster(static_cast<int>(i));
    return std::move(found_);
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }
  const Body& BodyOf(int body) const { return movable_.bodies[Index(body)]; }
  void Add(int line, const std::string& text) { written_.sdf.Add(line, text); }
  void Warn(int line, std::string text) { diagnostics_.Warning({file_, line}, std::move(text)); }

  /// Fixes the first fixed body to the world, and the other fixed bodies to the first.
  void WriteStill() {
    for (std::size_t i = 0; i < model_.still.size(); ++i) {
      const int line = BodyOf(model_.still[i]).line;
      const std::string parent = i == 0 ? "world" : links_.at(model_.still.front());
      Add(line, "<joint name=\"" + names_.New("held") + "\" type=\"fixed\">" + Tag("parent", parent) +
                    Tag("child", links_.at(model_.still[i])) + "</joint>");
    }
  }

  void WriteJoint(std::size_t index) {
    const Model::Link& link = model_.links[index];
    const Joint& joint = movable_.joints[Index(link.joint)];
    constexpr std::pair<Joint::Kind, const char*> kTypes[] = {{Joint::Kind::kHinge, "revolute"},
                                                              {Joint::Kind::kSlider, "prismatic"},
                                                              {Joint::Kind::kBall, "ball"},
                                                              {Joint::Kind::kFixed, "fixed"}};
    const char* type = "fixed";
    for (const auto& [kind, word] : kTypes) {
      if (kind == joint.kind) type = word;
    }
    const std::string name = names_.New(joint.name);
    found_.joints.push_back(name);
    if (joint.kind == Joint::Kind::kSixAxis) return WriteSixAxis(joint, link, name);
    const Body& child = BodyOf(link.child);
    Pose X_CJ = child.X_WB.Inverse() * joint.X_WJ;
    X_CJ.q = Quaternion::Identity();
    std::string text = "<joint name=\"" + name + "\" type=\"" + type + "\">" +
                       Tag("parent", link.parent == Joint::kWorld ? "world" : links_.at(link.parent)) +
                       Tag("child", links_.at(link.child)) + Tag("pose", Places(X_CJ));
    if (joint.kind == Joint::Kind::kHinge || joint.kind == Joint::Kind::kSlider) text += AxisOf(joint, link);
    if (joint.is_driven && joint.drive_train) {
      Add(joint.line, text);
      WriteDriveTrain(*joint.drive_train);
      text.clear();
    }
    Add(joint.line, text + "</joint>");
    written_.has_modules = written_.has_modules || joint.is_driven;
  }

  void WriteDriveTrain(const DriveTrain& train) {
    std::string text = "<coopdyn:drivetrain";
    const auto write = [&text](const char* name, std::optional<double> value) {
      if (value) text += std::string(" ") + name + "=\"" + Exact(*value) + "\"";
    };
    write("ratio", train.ratio);
    write("efficiency", train.efficiency);
    write("rotor_inertia_kg_m2", train.rotor_inertia_kg_m2);
    write("backlash_deg", train.backlash_deg);
    write("stiffness_nm_rad", train.stiffness_nm_rad);
    write("damping_nms_rad", train.damping_nms_rad);
    write("preload_nm", train.preload_nm);
    write("static_friction_nm", train.static_friction_nm);
    write("dynamic_friction_nm", train.dynamic_friction_nm);
    write("stiction_speed_rad_s", train.stiction_speed_rad_s);
    Add(train.line, text + ">");
    for (const DriveTrain::Pwm& row : train.pwm) {
      text = "<coopdyn:pwm";
      write("duty", row.duty);
      write("no_load_speed_rad_s", row.no_load_speed_rad_s);
      write("stall_torque_nm", row.stall_torque_nm);
      write("stall_current_a", row.stall_current_a);
      Add(row.line, text + "/>");
    }
    Add(train.line, "</coopdyn:drivetrain>");
  }

  void WriteSixAxis(const Joint& joint, const Model::Link& link, const std::string& name) {
    // From the other end, the axes are in reverse order and point the other way.
    const bool is_back = link.parent != Joint::kWorld && link.child == joint.source;
    std::vector<Joint> axes = joint.axes;
    if (is_back) std::ranges::reverse(axes);
    Add(joint.line, "<coopdyn:six_axis name=\"" + name + "\" parent=\"" +
                        (link.parent == Joint::kWorld ? "world" : links_.at(link.parent)) + "\" child=\"" +
                        links_.at(link.child) + "\" relative_to=\"__model__\" pose=\"" +
                        Places(model_.X_WR.Inverse() * joint.X_WJ) + "\">");
    for (const Joint& axis : axes) {
      std::string text = "<coopdyn:axis name=\"" + axis.name + "\"";
      const auto word = [&text](const char* key, double value) {
        text += std::string(" ") + key + "=\"" + Exact(value) + "\"";
      };
      if (axis.counts_source != is_back) {
        const char letter = axis.name.back();
        text += std::string(" xyz=\"") +
                (letter == 'x'   ? "-1 0 0"
                 : letter == 'y' ? "0 -1 0"
                                 : "0 0 -1") +
                "\"";
      }
      if (axis.limit && !IsFar(axis)) {
        word("lower", axis.limit->first);
        word("upper", axis.limit->second);
      }
      if (axis.is_driven) {
        word("max_effort", axis.max_effort);
        word("max_velocity", axis.max_velocity);
      }
      if (axis.damping > 0) word("damping", axis.damping);
      if (axis.friction > 0) word("friction", axis.friction);
      if (axis.stiffness > 0) {
        word("rest", axis.rest);
        word("stiffness", axis.stiffness);
      }
      Add(axis.line, text + "/>");
      written_.has_modules = written_.has_modules || axis.is_driven;
    }
    Add(joint.line, "</coopdyn:six_axis>");
  }

  /// Warns and returns true if a hinge without a motor has stops beyond 180 degrees.
  bool IsFar(const Joint& joint) {
    const bool is_far = joint.limit && joint.kind == Joint::Kind::kHinge && !joint.is_driven &&
                        (joint.limit->first < -std::numbers::pi || joint.limit->second > std::numbers::pi);
    if (is_far)
      Warn(joint.line,
           "stops of '" + Printable(joint.name) + "' beyond 180 degrees need a motor: it has none");
    return is_far;
  }

  std::string AxisOf(const Joint& joint, const Model::Link& link) {
    Vector3 axis = model_.X_WR.q.conjugate() * (joint.X_WJ.q * Vector3::UnitX());
    if (link.is_turned) axis = -axis;
    std::string limit;
    if (joint.limit && !IsFar(joint))
      limit += Tag("lower", Exact(joint.limit->first)) + Tag("upper", Exact(joint.limit->second));
    if (joint.is_driven && joint.max_effort > 0)
      limit += Tag("effort", Exact(joint.max_effort)) + Tag("velocity", Exact(joint.max_velocity));
    std::string dynamics;
    if (joint.damping > 0) dynamics += Tag("damping", Exact(joint.damping));
    if (joint.friction > 0) dynamics += Tag("friction", Exact(joint.friction));
    if (joint.stiffness > 0)
      dynamics +=
          Tag("spring_reference", Exact(joint.rest)) + Tag("spring_stiffness", Exact(joint.stiffness));
    return "<axis><xyz expressed_in=\"__model__\">" + Places(axis) + "</xyz>" +
           (limit.empty() ? "" : Tag("limit", limit)) + (dynamics.empty() ? "" : Tag("dynamics", dynamics)) +
           "</axis>";
  }

  void WriteDrive() {
    if (!model_.wheels) return;
    const auto& [left, right] = *model_.wheels;
    const int line = movable_.joints[Index(model_.links[Index(left)].joint)].line;
    Add(line, "<coopdyn:drive left_joint=\"" + found_.joints[Index(left)] + "\" right_joint=\"" +
                  found_.joints[Index(right)] + "\"/>");
    written_.AddModule(line, "motors", "motors");
  }

  void WriteMuscle(int index) {
    const Muscle& muscle = movable_.muscles[Index(index)];
    if (!links_.contains(muscle.source)) return;
    const std::string& name = found_.muscles.emplace(index, names_.New(muscle.name)).first->second;
    const auto point = [this](int body, const Vector3& p_W) {
      return Places(Vector3(BodyOf(body).X_WB.Inverse() * p_W));
    };
    std::string text = "<coopdyn:muscle name=\"" + name + "\" from=\"" + links_.at(muscle.source) +
                       "\" from_point=\"" + point(muscle.source, muscle.p_W_source) + "\" to=\"" +
                       links_.at(muscle.destination) + "\" to_point=\"" +
                       point(muscle.destination, muscle.p_W_destination) + "\"";
    const auto write = [&text](const char* name, double value) {
      text += std::string(" ") + name + "=\"" + Exact(value) + "\"";
    };
    write("max_force_n", muscle.max_force_n);
    write("optimal_length_m", muscle.optimal_length_m);
    write("width", muscle.width);
    write("c", muscle.c);
    if (muscle.use_velocity) {
      write("max_velocity_m_s", muscle.max_velocity_m_s);
      write("eccentric", muscle.eccentric);
      write("curvature", muscle.curvature);
    }
    if (!muscle.use_length) text += " use_length=\"false\"";
    if (!muscle.use_velocity) text += " use_velocity=\"false\"";
    Add(muscle.line, text + "/>");
    written_.has_modules = true;
  }

  void WriteThruster(int index) {
    const Thruster& thruster = movable_.thrusters[Index(index)];
    if (!links_.contains(thruster.body)) return;
    const std::string& name = found_.thrusters.emplace(index, names_.New(thruster.name)).first->second;
    Add(thruster.line, "<coopdyn:thruster name=\"" + name + "\" link=\"" + links_.at(thruster.body) +
                           "\" direction=\"" + Places(Vector3::Unit(thruster.axis)) + "\" " +
                           (thruster.turns ? "max_torque_nm" : "max_force_n") + "=\"" + Exact(thruster.most) +
                           "\"/>");
    written_.has_modules = true;
  }

  const Movable& movable_;
  const Model& model_;
  const std::map<int, std::string>& links_;
  const std::string& file_;
  Names& names_;
  WrittenModel& written_;
  Diagnostics& diagnostics_;
  JointNames found_;
};

}  // namespace

JointNames WriteJoints(const Movable& movable, const Model& model, const std::map<int, std::string>& links,
                       const std::string& file, Names& names, WrittenModel& written,
                       Diagnostics& diagnostics) {
  return JointWriter(movable, model, links, file, names, written, diagnostics).Write();
}

}  // namespace coopdyn::rosiml
