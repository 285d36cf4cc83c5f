// SPDX-License-Identifier: MIT
// A check's report as JSON.
#include <boost/json.hpp>

#include "server/app/check_report.h"
#include "server/app/model_text.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

json::array ListOf(const std::vector<Finding>& findings) {
  json::array list;
  for (const Finding& one : findings) {
    list.push_back({{"file", one.where.file},
                    {"line", one.where.line},
                    {"what", one.what},
                    {"why", one.why},
                    {"count", one.count}});
  }
  return list;
}

json::array JointsOf(const RobotModel& model) {
  json::array joints;
  for (const std::size_t j : MovingJoints(model)) {
    const JointModel& joint = model.joints[j];
    joints.push_back({{"name", joint.name},
                      {"type", ToString(joint.kind)},
                      {"motor", HasMotor(model, j)},
                      {"unit", joint.slides() ? "m" : "rad"},
                      {"lower", joint.lower},
                      {"upper", joint.upper},
                      {"effort", joint.max_effort},
                      {"velocity", joint.max_velocity}});
  }
  return joints;
}

json::value DriveOf(const std::optional<DriveLines>& drive) {
  if (!drive) return nullptr;
  return json::object{
      {"serve", drive->serve}, {"python", drive->python}, {"matlab", drive->matlab}, {"yarp", drive->yarp}};
}

json::array ModulesOf(const RobotModel& model) {
  json::array modules;
  for (const ModuleModel& module : model.modules())
    modules.push_back({{"name", module.name}, {"type", module.type}});
  return modules;
}

void AddModel(const RobotModel& model, json::object& object) {
  const Vector3 size = SizeOf(model);
  object["links"] = model.links.size();
  object["joints"] = JointsOf(model);
  object["modules"] = ModulesOf(model);
  object["mass_kg"] = MovingMass(model);
  object["size_m"] = {size.x(), size.y(), size.z()};
}

}  // namespace

json::object JsonOf(const CheckReport& report) {
  json::object object{{"file", report.file},
                      {"format", report.format},
                      {"name", report.name},
                      {"verdict", ToString(report.verdict)},
                      {"summary", report.lines.empty() ? "" : report.lines.front()}};
  if (report.model != nullptr) AddModel(*report.model, object);
  if (report.has_page && (report.model == nullptr || !report.robots.empty())) {
    json::array robots;
    for (const CheckedRobot& robot : report.robots) {
      json::object one{{"name", robot.name}};
      AddModel(*robot.model, one);
      one["drive"] = DriveOf(robot.drive);
      robots.push_back(std::move(one));
    }
    object["robots"] = std::move(robots);
  }
  object["errors"] = ListOf(report.errors);
  object["mended"] = ListOf(report.mended);
  object["left_out"] = ListOf(report.left_out);
  object["harmless"] = ListOf(report.harmless);
  json::array missing;
  for (const MissingPart& part : report.missing)
    missing.push_back(
        {{"what", part.what}, {"count", part.count}, {"collides", part.collides}, {"bring", part.bring}});
  object["missing"] = std::move(missing);
  object["drive"] = DriveOf(report.drive);
  return object;
}

}  // namespace coopdyn
