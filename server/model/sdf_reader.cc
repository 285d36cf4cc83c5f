// SPDX-License-Identifier: MIT
// Reads a robot's text with libsdformat. For its parts see sdf_body.h, for coopdyn's own elements
// sdf_parts.h.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <sdf/sdf.hh>
#include <string_view>
#include <utility>

#include "server/model/mjcf.h"
#include "server/model/readers.h"
#include "server/model/sdf_body.h"
#include "server/model/sdf_description.h"
#include "server/model/text_file.h"
#include "server/model/values.h"
#include "server/model/xacro.h"

namespace coopdyn {

namespace {

class RobotReader {
 public:
  RobotReader(const ModelSource& source, std::string file, std::string type, Diagnostics& diagnostics)
      : file_(std::move(file)), source_(source), diagnostics_(diagnostics) {
    robot_->type = std::move(type);
    robot_->file = file_;
  }

  std::shared_ptr<const RobotModel> Read() {
    robot_->text = source_.lines.empty() ? source_.text : WithMeshes(source_);
    for (const auto& [key, mesh] : source_.meshes) robot_->meshes.push_back(mesh.data);
    const tinyxml2::XMLElement* root = Parse();
    if (root == nullptr) return nullptr;
    sdf::Root loaded;
    const sdf::Model* model = Load(*root, loaded);
    if (model == nullptr) return nullptr;
    const tinyxml2::XMLElement& xml_model = *root->FirstChildElement("model");
    ModelReading reading{file_, source_, *robot_, diagnostics_};
    reading.assembly.sensors = std::move(sensors_);
    const std::vector<ModelScope> scopes = ScopesOf(*model, xml_model, reading);
    ReadLinks(scopes, reading);
    ReadJoints(scopes, reading);
    ReadAssembly(scopes, reading);
    if (!diagnostics_.has_errors())
      WeldLinks(reading.fixed, TiesOf(xml_model, *robot_), reading.lines, file_, *robot_, source_.foreign,
                diagnostics_);
    if (!diagnostics_.has_errors()) FindCollisions(*robot_, reading.assembly);
    if (!diagnostics_.has_errors()) MakeHulls(reading);
    if (!diagnostics_.has_errors())
      ReadCouplings(xml_model, reading.gearboxes, reading.fixed, source_.foreign, file_, *robot_,
                    diagnostics_);
    if (!diagnostics_.has_errors()) MoveToStart(reading);
    if (!diagnostics_.has_errors()) ReadExtension(xml_model, file_, reading.assembly, *robot_, diagnostics_);
    if (!diagnostics_.has_errors()) CheckStops(reading);
    if (!diagnostics_.has_errors()) CheckTrains(reading);
    if (diagnostics_.has_errors()) return nullptr;
    MeasureModel(reading);
    return diagnostics_.has_errors() ? nullptr : robot_;
  }

 private:
  void Error(int line, std::string text) { diagnostics_.Error({file_, line}, std::move(text)); }

  /// Reports and removes stops beyond ±180 degrees, ODE's limit, of hinges that no actuator drives.
  void CheckStops(ModelReading& reading) {
    for (std::size_t i = 0; i < robot_->joints.size(); ++i) {
      JointModel& joint = robot_->joints[i];
      const bool is_far = (std::isfinite(joint.lower) && joint.lower < -std::numbers::pi) ||
                          (std::isfinite(joint.upper) && joint.upper > std::numbers::pi);
      if (joint.kind != JointModel::Kind::kHinge || !is_far || robot_->IsDriven(static_cast<int>(i)))
        continue;
      reading.Complain(reading.lines.joints[i],
                       "a stop of joint '" + joint.name +
                           "' beyond 180 degrees needs a motor: write at most 3.1415, none, or "
                           "<limit><effort> and <velocity>",
                       "it has no stops", Diagnostic::Level::kWarning);
      joint.lower = -JointModel::kInfinity;
      joint.upper = JointModel::kInfinity;
    }
  }

  /// Reports drive trains of joints without a control board.
  void CheckTrains(const ModelReading& reading) {
    for (std::size_t i = 0; i < robot_->joints.size(); ++i) {
      const JointModel& joint = robot_->joints[i];
      const bool has_board = std::ranges::any_of(robot_->actuators, [i](const ActuatorModel& actuator) {
        return actuator.is_board() && std::ranges::count(actuator.joints, static_cast<int>(i)) > 0;
      });
      if (!joint.drive_train || has_board) continue;
      Error(reading.lines.joints[i], "joint '" + joint.name +
                                         "' has a <coopdyn:drivetrain> and belongs to no group: name it in a "
                                         "<coopdyn:group>");
    }
  }

  const tinyxml2::XMLElement* Parse() {
    // The original text has already been parsed; this is the composed one.
    if (document_.Parse(source_.text.c_str(), source_.text.size()) != tinyxml2::XML_SUCCESS) {
      Error(document_.ErrorLineNum(), std::string("not well-formed XML (") + document_.ErrorName() + ")");
      return nullptr;
    }
    const tinyxml2::XMLElement* root = document_.RootElement();
    return root != nullptr && IsModelCount(*root, file_, diagnostics_) ? root : nullptr;
  }

  const sdf::Model* Load(const tinyxml2::XMLElement& root, sdf::Root& loaded) {
    // libsdformat prints to the process's console; all its messages are also returned as errors.
    sdf::Console::Instance()->SetQuiet(true);
    sdf::SDFPtr description = DescriptionFor(root);
    Diagnostics found;
    CheckSdf(root, description->Root(), file_, found);
    if (!found.all().empty()) {  // messages list the allowed elements: check again with the whole schema
      description = WholeDescription(root);
      CheckSdf(root, description->Root(), file_, diagnostics_);
    }
    if (const auto* model = root.FirstChildElement("model"))
      sensors_ = ReadSensorElements(*model, file_, diagnostics_);
    // libsdformat would try a text with errors as URDF, whose parser prints to the console.
    if (diagnostics_.has_errors()) return nullptr;
    sdf::Errors errors;
    const sdf::ParserConfig config;
    if (sdf::readString(source_.text, config, description, errors)) {
      const sdf::Errors more = loaded.Load(description, config);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    for (const sdf::Error& error : errors) {
      // ReadLinks() handles this.
      if (source_.foreign && error.Code() == sdf::ErrorCode::LINK_INERTIA_INVALID) continue;
      constexpr std::size_t kMaxShown = 300;
      std::string text = error.Message().substr(0, kMaxShown);
      std::replace(text.begin(), text.end(), '\n', ' ');
      Error(error.LineNumber().value_or(0), std::move(text));
    }
    if (diagnostics_.has_errors()) return nullptr;
    if (loaded.Model() == nullptr) Error(root.GetLineNum(), "there is no <model>");
    return loaded.Model();
  }

  const std::string file_;
  const ModelSource& source_;
  Diagnostics& diagnostics_;
  std::shared_ptr<RobotModel> robot_ = std::make_shared<RobotModel>();
  tinyxml2::XMLDocument document_;
  std::vector<SdfSensor> sensors_;
};

}  // namespace

std::shared_ptr<const RobotModel> ReadRobotModel(const std::filesystem::path& file, const SearchPath& path,
                                                 Diagnostics& diagnostics) {
  const std::string name = file.string();
  std::optional<std::string> text = ReadTextFile(name, {name, 0}, diagnostics);
  const bool is_xacro = text && IsXacro(*text, file);
  if (is_xacro) text = ExpandXacro(file, path, diagnostics);
  if (!text) return nullptr;
  const std::string folder = std::filesystem::absolute(file).parent_path().filename().string();
  std::string stem = file.stem().string();
  if (is_xacro && stem.ends_with(".urdf")) stem.resize(stem.size() - 5);
  if (IsMjcf(*text)) {
    MeshFolder meshes;
    auto root = ReadMjcfRobot(file, path, meshes, diagnostics);
    if (!root) return nullptr;
    const Resources all = ResourcesOf(path, file, meshes);
    return ReadRobotModelTree(std::move(*root), name, stem, &all, false, diagnostics);
  }
  const Resources resources(path, file);
  auto robot = ReadRobotModelText(*text, name, stem == "model" ? folder : stem, diagnostics, &resources);
  if (is_xacro && robot == nullptr)
    diagnostics.Note({name, 0}, "the lines are those of what 'xacro " + name + "' writes");
  return robot;
}

std::shared_ptr<const RobotModel> ReadRobotModelText(const std::string& text, const std::string& file,
                                                     const std::string& type, Diagnostics& diagnostics,
                                                     const Resources* resources,
                                                     const std::filesystem::path& parts_folder) {
  Diagnostics found;
  std::shared_ptr<const RobotModel> robot;
  const std::optional<std::string> decoded = DecodeText(text, {file, 0}, found);
  auto source = decoded ? ComposeModel(*decoded, file, resources, found) : std::nullopt;
  diagnostics.Append(found);
  if (!source || found.has_errors()) return nullptr;
  source->parts_folder = resources == nullptr ? parts_folder : resources->parts_folder();
  Diagnostics read;
  robot = RobotReader(*source, file, type, read).Read();
  AppendMapped(read, file, *source, diagnostics);
  return robot;
}

std::shared_ptr<const RobotModel> ReadRobotModelTree(XmlNode root, const std::string& file,
                                                     const std::string& type, const Resources* resources,
                                                     bool in_world, Diagnostics& diagnostics) {
  Diagnostics found, read;
  ModelSource source;
  source.foreign = true;
  source.in_world = in_world;
  if (resources != nullptr) source.parts_folder = resources->parts_folder();
  ComposeTree(std::move(root), resources, source, found);
  diagnostics.Append(found);
  if (found.has_errors()) return nullptr;
  auto robot = RobotReader(source, file, type, read).Read();
  AppendMapped(read, file, source, diagnostics);
  return robot;
}

}  // namespace coopdyn
