// SPDX-License-Identifier: MIT
// Readers of .world files, .scenario files and robot models. They collect all errors as `file:line: error: …`
// before they give up.
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

/// Where to look for files: beside the file that names them, then in these folders in order (`--scenarios
/// DIR`, COOPDYN_PATH, the program's folder, the installed data), including their subfolders `scenarios/`,
/// `worlds/`, `robots/`, `controllers/`.
struct SearchPath {
  std::vector<std::filesystem::path> folders;
  /// Folders of Gazebo and ROS, only for model:// and package://.
  std::vector<std::filesystem::path> model_folders{};
  /// Caches of Gazebo Fuel (fuel.h).
  std::vector<std::filesystem::path> fuel_folders{};
  /// A missing mesh is an error, even if a box of the link's inertia could replace it.
  bool is_strict = false;
  /// Cache of convex parts of meshes (kept_parts.h); empty: no cache.
  std::filesystem::path parts_folder{};
  /// The one of `folders` for files that came over a socket; empty if none.
  std::filesystem::path uploads{};

  /// The first existing file for a scenario given by path or bare name; nullopt if none. It ends in
  /// .scenario, .world, .sdf, .xml, .urdf or .xacro, which the name may omit; only a path with a folder may
  /// have another extension. FindWorld() finds only .world files.
  std::optional<std::filesystem::path> FindScenario(const std::string& name) const;
  std::optional<std::filesystem::path> FindWorld(const std::string& name,
                                                 const std::filesystem::path& beside) const;
  /// The model of robots/<type>: model.sdf, model.urdf or the file that its model.config names.
  std::optional<std::filesystem::path> FindRobot(const std::string& type) const;
  /// True if `file` came over a socket. It may then name only those files of this machine that Resources
  /// allows.
  bool IsUpload(const std::filesystem::path& file) const;
  /// controllers/<name>.so or <name>.so in `beside` (unless empty) or on the path, for a bare name.
  std::optional<std::filesystem::path> FindController(const std::string& name,
                                                      const std::filesystem::path& beside = {}) const;
  /// Names of all controllers that FindController() finds, sorted.
  std::vector<std::string> ControllerNames(const std::filesystem::path& beside = {}) const;
  /// Names of all scenarios on the path, sorted, without extension.
  std::vector<std::string> ScenarioNames() const;
  /// The same for all .world files, and for all robots.
  std::vector<std::string> WorldNames() const;
  std::vector<std::string> RobotNames() const;
};

/// True if a robot's type is the path of a model: it has a folder or a #, or ends in .sdf, .urdf or .xacro.
bool IsModelPath(const std::string& type);
/// WORLD#MODEL, the type of a robot in an SDF world.
std::string WorldModelType(const std::filesystem::path& world, const std::string& model);
/// The MODEL of such a type; empty for another type.
std::string ModelOfWorldType(const std::string& type);
/// The name of that type in the world's own scenario: world.MODEL.
std::string ShortWorldModelType(const std::filesystem::path& world, const std::string& model);
/// A type that identifies `model` regardless of the folder of the text that uses it.
std::string TypeFromAnywhere(const RobotModel& model);

/// True for a name without folder, drive or leading dot. Texts from a socket may only use such names.
bool IsBareName(const std::string& name);

/// Parses each robot model once per process. Thread-safe.
class RobotLibrary {
 public:
  /// `embedded`: the worlds, textures and robot models of a recording (Scenario::sources). Readers use these
  /// before they look on `path`, and name their original files in messages. Missing controllers are then only
  /// warnings.
  explicit RobotLibrary(SearchPath path, std::vector<SourceText> embedded = {})
      : path_(std::move(path)), embedded_(std::move(embedded)) {}
  /// The model of `type`. Reports errors (at `where`, or in the model's file) and returns null on failure. A
  /// `type` that is a path (IsModelPath()) is relative to the folder `beside`; without one it is not read.
  std::shared_ptr<const RobotModel> Get(const std::string& type, const SourceLine& where,
                                        Diagnostics& diagnostics,
                                        const std::optional<std::filesystem::path>& beside = std::nullopt);
  /// True if a model `type` exists, with or without errors.
  bool Has(const std::string& type, const std::optional<std::filesystem::path>& beside = std::nullopt) const;
  /// Adds a model that has no own file.
  void Add(const std::string& type, std::shared_ptr<const RobotModel> model);
  /// The same for a model that was read from `text`.
  void AddMade(const std::string& type, const std::string& text, std::shared_ptr<const RobotModel> model);
  /// True if `type` was read from `text`.
  bool IsMade(const std::string& type, const std::string& text) const;
  /// The embedded text `name` of a `kind` (world, robot, texture); null if none.
  const SourceText* Embedded(std::string_view kind, std::string_view name) const;
  bool is_of_recording() const { return !embedded_.empty(); }
  const SearchPath& path() const { return path_; }

 private:
  /// The model `part` of the SDF world `world`; null unless it has been read.
  std::shared_ptr<const RobotModel> KnownOfWorld(const std::filesystem::path& world,
                                                 const std::string& part) const REQUIRES(mutex_);

  const SearchPath path_;
  const std::vector<SourceText> embedded_;
  mutable Mutex mutex_;
  std::unordered_map<std::string, std::shared_ptr<const RobotModel>> models_ GUARDED_BY(mutex_);
  std::unordered_map<std::string, std::string> made_of_ GUARDED_BY(mutex_);  // texts, by type
};

/// Reads a robot model: SDF 1.4 or newer with elements of the namespace `coopdyn:`, or URDF. Looks up files
/// that it names in its folder and on `path`. Null if it has errors.
std::shared_ptr<const RobotModel> ReadRobotModel(const std::filesystem::path& file, const SearchPath& path,
                                                 Diagnostics& diagnostics);
/// The same from a text. `file`: for messages. `resources`: null for a text without files; `parts_folder`
/// (see SearchPath) then replaces that of `resources`.
std::shared_ptr<const RobotModel> ReadRobotModelText(const std::string& text, const std::string& file,
                                                     const std::string& type, Diagnostics& diagnostics,
                                                     const Resources* resources = nullptr,
                                                     const std::filesystem::path& parts_folder = {});

/// Reads the text of a .world. Reports errors and returns the readable parts. `textures`: of `file`; null for
/// a text without files.
WorldModel ReadWorld(const std::string& text, const std::string& file, Diagnostics& diagnostics,
                     Textures* textures = nullptr);

/// Reads the text of a .scenario and all files that it names, and keeps their texts in `sources`. Null if
/// there are errors. With these sources embedded in `robots`, the same text, file and seed give the same
/// scenario again. `file`: for messages and for files beside it; kPipe if none. `by_socket`: worlds, robots
/// and controllers only by bare name on the path. `seed`: replaces the scenario's seed (`--seed`), also for
/// the places of swarms, unless their sections have their own `seed`.
std::shared_ptr<const Scenario> ReadScenario(const std::string& text, const std::string& file,
                                             RobotLibrary& robots, bool by_socket, Diagnostics& diagnostics,
                                             std::optional<std::uint64_t> seed = std::nullopt);
/// Why nothing of that kind may have the name `name`; empty if it is allowed.
enum class NamedKind { kThing, kLight, kRobot };
std::string WhyNoName(const std::string& name, NamedKind kind);

/// Reads sections for insertion into the world of `around`, whose floor, things and robots restrict the
/// places of swarms and copies and reserve their names. Returns only the new parts; null if there are errors.
/// Files as with `by_socket`.
std::shared_ptr<const Scenario> ReadInsertion(const std::string& text, RobotLibrary& robots,
                                              const Scenario& around, Diagnostics& diagnostics);
/// Finds and reads a scenario (or a .world, as a scenario without robots) by path or bare name.
/// `by_socket`: the name came over a socket, so it must be a bare name on the search path. `seed`: as above.
/// `settings`: see settings.h.
std::shared_ptr<const Scenario> LoadScenario(const std::string& name, RobotLibrary& robots,
                                             Diagnostics& diagnostics, bool by_socket = false,
                                             std::optional<std::uint64_t> seed = std::nullopt,
                                             const std::vector<std::string>& settings = {});

}  // namespace coopdyn
