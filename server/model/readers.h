// SPDX-License-Identifier: MIT
// Readers of .world, .scenario and robot models. They collect every mistake as `file:line: error: …` before
// they give up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/base/mutex.h"
#include "server/model/scenario.h"

namespace coopdyn {

class Resources;
class Textures;

/// Where files are looked for: beside the naming file, then these folders in order (`--scenarios DIR`,
/// COOPDYN_PATH, the program's folder, the installed data). In each, also in its subfolders `scenarios/`,
/// `worlds/`, `robots/`, `controllers/`.
struct SearchPath {
  std::vector<std::filesystem::path> folders;
  /// Only for what models name by model:// and package://: those of Gazebo and ROS.
  std::vector<std::filesystem::path> model_folders{};
  /// Caches of Gazebo's Fuel (fuel.h).
  std::vector<std::filesystem::path> fuel_folders{};
  /// A mesh that is not there is an error, also where a box of the link's inertia would do.
  bool is_strict = false;
  /// Where convex parts of meshes are kept (kept_parts.h); empty: nowhere.
  std::filesystem::path parts_folder{};
  /// One of `folders`, where files are that came over a socket; empty: there is none.
  std::filesystem::path uploads{};

  /// The first existing file for a scenario/world given by path or bare name; nothing if none. It ends in
  /// .scenario, .world, .sdf or .xml, which the name may leave out; only a path with a folder may end in
  /// something else.
  std::optional<std::filesystem::path> FindScenario(const std::string& name) const;
  std::optional<std::filesystem::path> FindWorld(const std::string& name,
                                                 const std::filesystem::path& beside) const;
  /// The model of robots/<type>: model.sdf, model.urdf or what its model.config names.
  std::optional<std::filesystem::path> FindRobot(const std::string& type) const;
  /// Whether `file` came over a socket: it may name files of this machine only as Resources lets it.
  bool IsUpload(const std::filesystem::path& file) const;
  /// controllers/<name>.so or <name>.so in `beside` (unless that is empty) or on the path, for a bare name.
  std::optional<std::filesystem::path> FindController(const std::string& name,
                                                      const std::filesystem::path& beside = {}) const;
  /// Names of all controllers that FindController() finds, sorted.
  std::vector<std::string> ControllerNames(const std::filesystem::path& beside = {}) const;
  /// Names of all scenarios on the path, sorted, without extension.
  std::vector<std::string> ScenarioNames() const;
  /// Likewise of all .world files, and of all robots.
  std::vector<std::string> WorldNames() const;
  std::vector<std::string> RobotNames() const;
};

/// Whether a robot's type is the path of a model: it has a folder or a #, or ends in .sdf, .urdf or .xacro.
bool IsModelPath(const std::string& type);
/// WORLD#MODEL, the type of a robot that an SDF world describes, and its MODEL; empty for another type.
std::string WorldModelType(const std::filesystem::path& world, const std::string& model);
std::string ModelOfWorldType(const std::string& type);
/// What the scenario of an SDF world calls that type: world.MODEL.
std::string ShortWorldModelType(const std::filesystem::path& world, const std::string& model);
/// The type that means `model` wherever a text with it is kept.
std::string TypeFromAnywhere(const RobotModel& model);

/// True for a name without folders, drives and a leading dot, as texts from a socket may name files.
bool IsBareName(const std::string& name);

/// Parses each robot model once per process. Any thread.
class RobotLibrary {
 public:
  /// `embedded`: the worlds, textures and robot models that a recording carries (Scenario::sources). Readers
  /// take these before they look on `path`, and call them in messages by the file that they came from.
  /// Controllers that are not there any more are then warnings.
  explicit RobotLibrary(SearchPath path, std::vector<SourceText> embedded = {})
      : path_(std::move(path)), embedded_(std::move(embedded)) {}
  /// The model of `type`; null with diagnostics (at `where`, or in the model's file) if there is none. A
  /// `type` that is a path (IsModelPath()) starts at the folder `beside`; without one it is not read.
  std::shared_ptr<const RobotModel> Get(const std::string& type, const SourceLine& where,
                                        Diagnostics& diagnostics,
                                        const std::optional<std::filesystem::path>& beside = std::nullopt);
  /// Whether there is a model called `type`, with or without errors.
  bool Has(const std::string& type, const std::optional<std::filesystem::path>& beside = std::nullopt) const;
  /// Keeps a model that has no file of its own.
  void Add(const std::string& type, std::shared_ptr<const RobotModel> model);
  /// The same of one that was read of `text`; and whether `type` is that.
  void AddMade(const std::string& type, const std::string& text, std::shared_ptr<const RobotModel> model);
  bool IsMade(const std::string& type, const std::string& text) const;
  /// The embedded text `name` of a `kind` (world, robot, texture); null if there is none.
  const SourceText* Embedded(std::string_view kind, std::string_view name) const;
  bool is_of_recording() const { return !embedded_.empty(); }
  const SearchPath& path() const { return path_; }

 private:
  /// The model `part` of the SDF world `world`, if that has been read.
  std::shared_ptr<const RobotModel> KnownOfWorld(const std::filesystem::path& world,
                                                 const std::string& part) const REQUIRES(mutex_);

  const SearchPath path_;
  const std::vector<SourceText> embedded_;
  mutable Mutex mutex_;
  std::unordered_map<std::string, std::shared_ptr<const RobotModel>> models_ GUARDED_BY(mutex_);
  std::unordered_map<std::string, std::string> made_of_ GUARDED_BY(mutex_);  // texts, by type
};

/// Reads a robot model: SDF 1.4 or newer with our own elements in the namespace `coopdyn:`, or URDF. What it
/// names is looked up in its folder and on `path`. Null if it has errors.
std::shared_ptr<const RobotModel> ReadRobotModel(const std::filesystem::path& file, const SearchPath& path,
                                                 Diagnostics& diagnostics);
/// The same from a text instead of from the disk. `file`: for messages. `resources`: null for a text without
/// files, whose `parts_folder` is given instead (SearchPath).
std::shared_ptr<const RobotModel> ReadRobotModelText(const std::string& text, const std::string& file,
                                                     const std::string& type, Diagnostics& diagnostics,
                                                     const Resources* resources = nullptr,
                                                     const std::filesystem::path& parts_folder = {});

/// Reads the text of a .world. Errors go to `diagnostics`; what could be read is returned. `textures`: of
/// `file`; null for a text without files.
WorldModel ReadWorld(const std::string& text, const std::string& file, Diagnostics& diagnostics,
                     Textures* textures = nullptr);

/// Reads the text of a .scenario and all that it names, whose texts it keeps in `sources`. Nothing if there
/// are errors. With these sources embedded in `robots`, text, file and seed give the same scenario again.
/// `file`: for messages and for what lies beside it; kPipe if there is none. `by_socket`: worlds, robots and
/// controllers only by bare name on the path. `seed`: instead of the scenario's (`--seed`), for the places of
/// swarms too; a `seed` in their own sections stays.
std::shared_ptr<const Scenario> ReadScenario(const std::string& text, const std::string& file,
                                             RobotLibrary& robots, bool by_socket, Diagnostics& diagnostics,
                                             std::optional<std::uint64_t> seed = std::nullopt);
/// Why nothing of that kind can be called `name`; empty: it can.
enum class NamedKind { kThing, kLight, kRobot };
std::string WhyNoName(const std::string& name, NamedKind kind);

/// Reads sections that are to be inserted into a world in which `around` stands: its floor, things and robots
/// leave places for swarms and copies, and have their names. Only what is new is returned. Nothing if there
/// are errors. Files as with `by_socket`.
std::shared_ptr<const Scenario> ReadInsertion(const std::string& text, RobotLibrary& robots,
                                              const Scenario& around, Diagnostics& diagnostics);
/// Finds and reads a scenario (or a .world, as a scenario without robots) by path or bare name.
/// `by_socket`: the name came over a socket, so only a bare name on the search path will do. `seed`: as
/// above. `settings`: settings.h.
std::shared_ptr<const Scenario> LoadScenario(const std::string& name, RobotLibrary& robots,
                                             Diagnostics& diagnostics, bool by_socket = false,
                                             std::optional<std::uint64_t> seed = std::nullopt,
                                             const std::vector<std::string>& settings = {});

}  // namespace coopdyn
