// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "server/base/printable.h"
#include "server/model/experiment.h"
#include "server/model/random_sections.h"
#include "server/model/readers.h"
#include "server/model/robot_sections.h"
#include "server/model/score_sections.h"
#include "server/model/section_reader.h"
#include "server/model/settings.h"
#include "server/model/text_file.h"
#include "server/model/textures.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The name of a scenario that came as a text: that of the file in its last line, "# file: lesson.scenario",
/// which the page and `coopdyn load` add; else "(text)".
std::string NameInText(std::string_view text) {
  constexpr std::string_view kMark = "# file: ", kEnds = "\r\n";
  constexpr std::size_t kMaxBytes = 100;
  text = text.substr(0, text.find_last_not_of(kEnds) + 1);
  std::string_view file = text.substr(text.find_last_of(kEnds) + 1);
  if (!file.starts_with(kMark)) return "(text)";
  file.remove_prefix(kMark.size());
  file = Trim(file.substr(file.find_last_of("/\\") + 1));
  std::string name = std::filesystem::path(file).stem().string();
  return name.empty() || name.size() > kMaxBytes || name != Printable(name) ? "(text)" : name;
}

/// The folder of a scenario's own files; nullopt if it came by socket.
std::optional<std::filesystem::path> FolderOf(const std::string& file, bool by_socket) {
  if (by_socket) return std::nullopt;
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  return folder.empty() ? std::filesystem::path(".") : folder;
}

class ScenarioReader {
 public:
  ScenarioReader(const std::string& file, RobotLibrary& library, bool by_socket,
                 std::optional<std::uint64_t> seed, Diagnostics& diagnostics)
      : label_(file.empty() ? "(text)" : file),
        library_(library),
        by_socket_(by_socket),
        seed_(seed),
        diagnostics_(diagnostics),
        robots_(*scenario_, library, FolderOf(file, by_socket), diagnostics),
        textures_(library, label_, "", !by_socket) {
    scenario_->file = by_socket ? "" : file;
    if (!by_socket && file != kPipe) scenario_->name = std::filesystem::path(file).stem().string();
  }

  /// Sets the existing world. Call it before Read().
  void Surround(const Scenario& around) {
    scenario_->floor = around.floor;
    scenario_->simulation.seed = around.simulation.seed;
    for (WorldObject object : around.objects) {
      object.where = {kAround, 0};
      AddObject(object);
    }
    for (const PointLight& light : around.lights) {
      AddLight(light);
      scenario_->lights.back().where = {kAround, 0};
    }
    for (RobotEntry robot : around.robots) {
      robot.where = {kAround, 0};
      robots_.AddAround(std::move(robot));
    }
  }
  static constexpr const char* kAround = "the world";

  std::shared_ptr<const Scenario> Read(const std::string& text) {
    std::optional<std::string> decoded = DecodeText(text, {label_, 0}, diagnostics_);
    if (!decoded) return nullptr;
    scenario_->text = std::move(*decoded);
    if (by_socket_ || label_ == kPipe) scenario_->name = NameInText(scenario_->text);
    sections_ = IsExperiment(scenario_->text, label_)
                    ? ReadExperiment(scenario_->text, label_, scenario_->name, !by_socket_ && label_ != kPipe,
                                     library_, diagnostics_)
                    : ReadSections(scenario_->text, label_, diagnostics_);
    ApplySettings(sections_, label_, diagnostics_);
    DrawRandom();
    if (!ReadStanding()) return nullptr;
    AddScattered(scattered_, robots_.TakenPlaces(), *scenario_, diagnostics_);
    for (const Section& section : sections_) {
      if (!IsNumbered(section.word, "swarm")) continue;
      if (diagnostics_.StopAt({label_, section.line})) return nullptr;
      SectionReader reader(section, label_, degrees_, diagnostics_);
      robots_.ReadSwarm(reader);
    }
    robots_.SortAsInFile();
    if (!diagnostics_.has_errors()) CheckScores(*scenario_, diagnostics_);
    AddSources(textures_);
    return diagnostics_.has_errors() ? nullptr : scenario_;
  }

 private:
  /// Reads everything except swarms and copies, which need free places.
  bool ReadStanding() {
    FindDegrees();
    // Dependencies first: swarms need the floor and the seed, and the places of objects and robots.
    ReadFirst("simulation", [this](SectionReader& reader) { ReadSimulation(reader); });
    scenario_->simulation.own_seed = scenario_->simulation.seed;
    if (seed_) scenario_->simulation.seed = *seed_;
    ReadFirst("world", [this](SectionReader& reader) { ReadWorldFile(reader); });
    ReadFirst("floor", [this](SectionReader& reader) { ReadOwnFloor(reader); });
    ReadFirst("target", [this](SectionReader& reader) { ReadTargets(reader); });
    for (const Section& section : sections_) {
      if (diagnostics_.StopAt({label_, section.line})) return false;
      ReadPlain(section);
    }
    return true;
  }

  void DrawRandom() {
    RandomSections random(sections_, label_, diagnostics_);
    if (random.empty() || diagnostics_.has_errors()) return;
    std::uint64_t seed = seed_.value_or(scenario_->simulation.seed);
    if (const Section* simulation = FirstSection("simulation"); simulation != nullptr && !seed_) {
      Diagnostics later;
      SectionReader reader(*simulation, label_, false, later);
      Take(reader.WholeNumber("seed", 0, kMaxSeed), seed);
    }
    scenario_->random = random.Draw(
        seed, sections_, [this](const std::vector<Section>& sections) -> std::shared_ptr<const Scenario> {
          Diagnostics later;
          ScenarioReader reader(label_, library_, by_socket_, seed_, later);
          reader.sections_ = sections;
          const bool read = reader.ReadStanding() && !later.has_errors();
          return read ? reader.scenario_ : nullptr;
        });
  }

  /// " (file:line)"; empty if not from a file.
  static std::string At(const SourceLine& where) {
    return where.line == 0 ? "" : " (" + where.file + ":" + std::to_string(where.line) + ")";
  }

  void AddSources(const Textures& textures) {
    const std::vector<SourceText>& sources = textures.sources();
    scenario_->sources.insert(scenario_->sources.end(), sources.begin(), sources.end());
  }

  void AddLight(const PointLight& light) {
    if (scenario_->lights.size() == kMaxLights) {
      diagnostics_.Error(light.where, "a scenario has at most " + std::to_string(kMaxLights) + " lights");
      return;
    }
    const auto same = [&light](const PointLight& other) {
      return ToLower(other.name) == ToLower(light.name);
    };
    const auto first = std::ranges::find_if(scenario_->lights, same);
    if (first != scenario_->lights.end() && first->where.file != light.where.file) {
      diagnostics_.Error(light.where, "[" + light.name + "] stands in the world too" + At(first->where) +
                                          ": give it another name");
    }
    scenario_->lights.push_back(light);
  }

  const Section* FirstSection(const std::string& word) const {
    const auto found =
        std::find_if(sections_.begin(), sections_.end(), [&](const Section& s) { return s.word == word; });
    return found == sections_.end() ? nullptr : &*found;
  }

  template <typename F>
  void ReadFirst(const std::string& word, F read) {
    const Section* section = FirstSection(word);
    if (section == nullptr) return;
    SectionReader reader(*section, label_, degrees_, diagnostics_);
    read(reader);
  }

  /// Reads `angles` of [SIMULATION], and of [FLOOR], so that a .world is also a scenario without robots.
  void FindDegrees() {
    for (const char* word : {"floor", "simulation"}) {
      const Section* section = FirstSection(word);
      if (section == nullptr) continue;
      if (SaysDegrees(*section, label_, diagnostics_)) degrees_ = true;
    }
  }

  void ReadSimulation(SectionReader& reader) {
    SimulationOptions& options = scenario_->simulation;
    reader.Has("angles");
    options.mode = reader.Choice<Mode>("mode", kModeWords);
    ReadStep(reader, options);
    Take(reader.WholeNumber("seed", 0, kMaxSeed), options.seed);
    options.speed = reader.Number("speed", Quantity::kPlain, -kMaxSpeed, kMaxSpeed);
    options.duration_s = reader.Number("duration", Quantity::kTime, 0, kMaxDuration_s);
    if (options.duration_s && *options.duration_s <= 0)
      reader.ErrorAt("duration", "'duration' must be above 0 s");
    options.watchdog_s = ReadWatchdog(reader);
    ReadGravity(reader, options);
    options.overlaps = reader.YesNo("overlaps").value_or(false);
    ambient_light_ = ReadAmbientLight(reader);
    if (ambient_light_) scenario_->ambient_light = *ambient_light_;
    ReadWaitsFor(reader, options);
    options.supervisor = ReadController(reader, kSupervisorKey, library_, FolderOf(label_, by_socket_));
    reader.Finish();
  }

  /// Reads `gravity 9.81`, or as a vector in the world: `gravity 0 0 -9.81`.
  static void ReadGravity(SectionReader& reader, SimulationOptions& options) {
    constexpr double kMaxGravity = 1000;
    const auto numbers =
        reader.Numbers("gravity", Quantity::kPlain, {1, 3}, "m/s² downwards, or x y z of the acceleration",
                       -kMaxGravity, kMaxGravity);
    if (!numbers) return;
    if (numbers->size() == 3) {
      options.g_W = Vector3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
      return;
    }
    const double down = numbers->front();
    options.g_W = Vector3(0, 0, 0 - down);
    if (down >= 0) return;
    reader.WarningAt("gravity", "'gravity' counts downwards, so things fall up with " + FormatNumber(down) +
                                    " m/s²: write " + FormatNumber(-down) + " if they should fall down");
  }

  /// Reads `waits_for yarp /my/controller …`.
  static void ReadWaitsFor(SectionReader& reader, SimulationOptions& options) {
    const std::optional<std::string> text = reader.Text("waits_for");
    if (!text) return;
    std::istringstream words(*text);
    std::string word;
    words >> word;
    const bool yarp = word == "yarp";
    bool good = yarp;
    while (words >> word) {
      good &= word.size() > 1 && word.starts_with('/') && !word.ends_with('/');
      options.waits_for.push_back(word);
    }
    if (!good || options.waits_for.empty()) {
      reader.ErrorAt("waits_for",
                     "lockstep waits for programs of YARP by the names of their ports: write 'waits_for yarp "
                     "/my/controller'; for robots it waits anyhow");
    }
  }

  void ReadStep(SectionReader& reader, SimulationOptions& options) {
    const auto step_s = reader.Number("step", Quantity::kTime, -1e9, 1e9);
    if (step_s) {
      const double microseconds = *step_s * 1e6;
      const double whole = std::round(microseconds);
      if (*step_s < ToSeconds(kMinStep) * (1 - 1e-9) || *step_s > ToSeconds(kMaxStep) * (1 + 1e-9)) {
        reader.ErrorAt("step",
                       "'step' must lie between 0.5ms and 100ms (a number without unit is in s), not at " +
                           FormatNumber(*step_s) + " s");
      } else if (std::abs(microseconds - whole) > 1e-6) {
        reader.ErrorAt("step", "'step' must be whole microseconds, not " + FormatNumber(microseconds));
      } else {
        options.step = static_cast<Nanoseconds>(whole) * 1000;
      }
    }
    const auto substeps = reader.WholeNumber("substeps", 1, 1000);
    if (!substeps) return;
    options.substeps = static_cast<int>(*substeps);
    const Nanoseconds step = options.step.value_or(kDefaultStep);
    if (step > kMaxSubstep * static_cast<Nanoseconds>(*substeps)) {
      reader.ErrorAt("substeps", "a substep may last 10 ms at most: a step of " +
                                     FormatNumber(ToSeconds(step) * 1e3) + " ms needs at least " +
                                     std::to_string((step + kMaxSubstep - 1) / kMaxSubstep) + " substeps");
    }
  }

  void ReadWorldFile(SectionReader& reader) {
    reader.Require("file", "file corridor.world");
    const std::optional<std::string> name = reader.Text("file");
    reader.Finish();
    if (!name) return;
    std::optional<SourceText> source = FindWorld(*name, reader.LineOf("file"));
    if (!source) return;
    Textures textures(library_, source->file, source->name, !by_socket_);
    scenario_->world = ReadWorld(source->text, source->file, diagnostics_, &textures);
    AddSources(textures);
    for (const PointLight& light : scenario_->world.lights) AddLight(light);
    if (!ambient_light_) scenario_->ambient_light = scenario_->world.ambient_light.value_or(0);
    source->text = scenario_->world.text;
    scenario_->sources.push_back(std::move(*source));
    if (scenario_->world.floor) scenario_->floor = *scenario_->world.floor;
    for (const WorldObject& object : scenario_->world.objects) AddObject(object);
    scattered_ = scenario_->world.scattered;
  }

  /// The text of the world `name`, embedded in a recording or from a file. Reports an error at `where` and
  /// returns nullopt on failure.
  std::optional<SourceText> FindWorld(const std::string& name, const SourceLine& where) {
    if (const SourceText* embedded = library_.Embedded("world", name)) return *embedded;
    if (by_socket_ && !IsBareName(name)) {
      diagnostics_.Error(where,
                         "a scenario sent over a socket names its world by the bare name of a file on the "
                         "search path, for example: file corridor.world");
      return std::nullopt;
    }
    const std::filesystem::path beside = FolderOf(label_, by_socket_).value_or(std::filesystem::path());
    const auto path = library_.path().FindWorld(name, beside);
    if (!path) {
      diagnostics_.Error(where, "there is no world '" + name + "' beside the scenario or on the search path");
      return std::nullopt;
    }
    const std::string file = path->string();
    std::optional<std::string> text = ReadTextFile(file, where, diagnostics_);
    if (!text) return std::nullopt;
    return SourceText{"world", name, file, std::move(*text)};
  }

  void ReadOwnFloor(SectionReader& reader) {
    if (scenario_->world.floor) {
      const SourceLine& first = scenario_->world.floor->where;
      const std::string there = first.file + ":" + std::to_string(first.line);
      reader.Error(
          reader.section().set_as.empty()
              ? "[FLOOR] stands in the world too (" + there + "): keep one of them"
              : "the floor is that of the world, " + there +
                    ", whose keys --set does not change: write a world with another one, and name it "
                    "with --set WORLD.file=mine.world");
    }
    std::optional<double> ambient_light;
    const Floor floor = ReadFloor(reader, textures_, ambient_light);
    if (ambient_light && !ambient_light_) scenario_->ambient_light = *ambient_light;
    if (!scenario_->world.floor) scenario_->floor = floor;
  }

  void ReadTargets(SectionReader& reader) {
    for (const Entry& entry : reader.section().entries) {
      if (diagnostics_.StopAt(entry.In(label_))) return;
      Target target;
      target.where = entry.In(label_);
      target.color_name = ColorWord(entry);
      // Read each entry separately, because the keys of a [TARGET] may repeat.
      const Section alone{reader.section().name, "target", entry.line, {entry}};
      SectionReader values(alone, label_, degrees_, diagnostics_);
      const auto p = values.Numbers(entry.key, Quantity::kLength, {2, 3}, "x y, or x y z", -kMaxFileLength_m,
                                    kMaxFileLength_m);
      if (target.color_name.empty() || !p) continue;
      target.color = NamedColor(target.color_name).value_or(Color());
      target.p_WT = Vector3((*p)[0], (*p)[1], p->size() == 3 ? (*p)[2] : 0);
      target.id = TargetId{static_cast<std::uint32_t>(scenario_->targets.size() + 1)};
      scenario_->targets.push_back(std::move(target));
    }
  }

  /// The colour word for a key of [TARGET]. Reports an error and returns an empty text if it is not a colour.
  std::string ColorWord(const Entry& entry) {
    if (NamedColor(entry.key)) return entry.key;
    for (const std::string prefix : {"color_", "colour_"}) {
      if (!entry.key.starts_with(prefix)) continue;
      const std::string digits = entry.key.substr(prefix.size());
      const bool number = !digits.empty() && digits.size() <= 6 && digits.front() != '0' &&
                          digits.find_first_not_of("0123456789") == std::string::npos;
      if (number) return PaletteName(std::stoi(digits));
    }
    const std::string near = Nearest(entry.key, ColorNames());
    diagnostics_.Error(entry.In(label_), "unknown colour '" + entry.key + "' in [TARGET]" +
                                             (near.empty() ? "; write a colour word, for example: red 3 0"
                                                           : "; did you mean '" + near + "'?"));
    return {};
  }

  /// The keys of [TASK] may repeat: each `text` is a paragraph or, if it begins with '-', an item of a list.
  void ReadTask(const Section& section) {
    Task& task = scenario_->task;
    bool in_list = false;
    for (const Entry& entry : section.entries) {
      const std::string value(Trim(entry.value));
      const bool is_text = entry.key == "text";
      if (value.empty()) {
        diagnostics_.Error(entry.In(label_), "'" + entry.key + "' in [TASK] has no text");
      } else if (entry.key == "title") {
        if (!task.title.empty()) diagnostics_.Error(entry.In(label_), "[TASK] has one title");
        task.title = value;
      } else if (is_text) {
        const bool item = value.starts_with("- ");
        if (!task.text.empty()) task.text += item && in_list ? "\n" : "\n\n";
        task.text += value;
        in_list = item;
      } else if (entry.key == "hint") {
        task.hints.push_back(value);
      } else if (entry.key == "counts") {
        task.counts.push_back(value);
      } else {
        static const std::vector<std::string> kKeys = {"title", "text", "hint", "counts"};
        diagnostics_.Error(entry.In(label_),
                           "unknown key '" + entry.key + "' in [TASK]" + DidYouMean(entry.key, kKeys));
      }
      if (task.text.size() > Task::kMaxTextBytes || task.hints.size() > Task::kMaxHints ||
          task.counts.size() > Task::kMaxHints) {
        diagnostics_.Error(entry.In(label_),
                           "[TASK] has at most 20000 bytes of text, 20 hints and 20 lines of 'counts'");
        return;
      }
    }
  }

  void ReadView(SectionReader& reader) {
    View& view = scenario_->view;
    const auto point = [&](const char* key) -> std::optional<Vector3> {
      const auto p =
          reader.Numbers(key, Quantity::kLength, {3}, "x y z", -kMaxFileLength_m, kMaxFileLength_m);
      return p ? std::optional(Vector3((*p)[0], (*p)[1], (*p)[2])) : std::nullopt;
    };
    const bool has_from = reader.Has("from"), has_eye = reader.Has("eye"), has_look = reader.Has("look");
    if (has_from == (has_eye || has_look) || has_eye != has_look) {
      reader.Error(
          "[VIEW] says either 'from' (whole, top, front or side), or 'eye' and 'look', for example: eye 3 -2 "
          "2 "
          "and look 0 0 0.2");
    }
    if (const auto from = reader.Choice<View::From>("from", View::kWords)) view.from = *from;
    const std::optional<Vector3> eye_W = point("eye"), look_W = point("look");
    if (eye_W && look_W && (*eye_W - *look_W).norm() < 0.01)
      reader.ErrorAt("eye", "'eye' must be at least 1 cm away from 'look'");
    if (eye_W) view.eye_W = *eye_W;
    view.look_W = look_W;
    reader.Finish();
  }

  /// Reads robots and objects.
  void ReadPlain(const Section& section) {
    static const std::vector<std::string> kOwn = {"WORLD",   "SIMULATION", "TARGET",  "FLOOR",
                                                  "ROBOT_1", "SWARM_1",    "LIGHT_1", "SCORE_1",
                                                  "RANDOM",  "TASK",       "VIEW"};
    for (const char* word : {"world", "simulation", "target", "floor"}) {
      if (section.word == word) return;
    }
    if (IsNumbered(section.word, "swarm")) return;
    if (section.word == "task") return ReadTask(section);
    SectionReader reader(section, label_, degrees_, diagnostics_);
    if (section.word == "view") return ReadView(reader);
    if (IsNumbered(section.word, "robot")) {
      if (const std::optional<WorldObject> bar = robots_.ReadRobot(reader)) {
        bars_.insert(ToLower(bar->name));
        AddObject(*bar);
      }
      return;
    }
    if (IsNumbered(section.word, "score")) {
      const std::optional<ScoreEntry> score = ReadScore(reader);
      if (scenario_->scores.size() == kMaxScores) {
        reader.Error("a scenario has at most " + std::to_string(kMaxScores) + " scores");
      } else if (score) {
        scenario_->scores.push_back(*score);
      }
      return;
    }
    if (IsNumbered(section.word, "light")) {
      if (const std::optional<PointLight> light = ReadLight(reader)) AddLight(*light);
      return;
    }
    ObjectSection read = ReadObject(reader, kOwn, textures_);
    if (read.object) AddObject(*read.object);
    if (read.scattered) scattered_.push_back(std::move(*read.scattered));
  }

  void AddObject(const WorldObject& object) {
    const auto [first, is_new] = objects_.emplace(ToLower(object.name), object.where);
    // Duplicates in one file have already been reported, except with a team's bar.
    if (!is_new && bars_.contains(first->first)) {
      const SourceLine& other = first->second;
      diagnostics_.Error(object.where, "'" + object.name + "' is the name of a team's bar and of a thing (" +
                                           other.file + ":" + std::to_string(other.line) +
                                           "): give one another name");
    } else if (!is_new && first->second.file != object.where.file) {
      diagnostics_.Error(object.where, "[" + object.name + "] stands in the world too" + At(first->second) +
                                           ": give it another name");
    }
    scenario_->objects.push_back(object);
  }

  const std::string label_;  // in messages
  RobotLibrary& library_;
  const bool by_socket_;
  const std::optional<std::uint64_t> seed_;
  Diagnostics& diagnostics_;
  std::shared_ptr<Scenario> scenario_ = std::make_shared<Scenario>();
  RobotSections robots_;
  Textures textures_;                    // of the scenario itself
  std::optional<double> ambient_light_;  // of [SIMULATION]
  std::vector<Section> sections_;
  bool degrees_ = false;
  std::unordered_map<std::string, SourceLine> objects_;  // by name in lower case
  std::unordered_set<std::string> bars_;                 // names in objects_ of teams' bars
  std::vector<ScatteredObjects> scattered_;              // the world's, then the scenario's own
};

}  // namespace

std::shared_ptr<const Scenario> ReadScenario(const std::string& text, const std::string& file,
                                             RobotLibrary& robots, bool by_socket, Diagnostics& diagnostics,
                                             std::optional<std::uint64_t> seed) {
  Diagnostics found(file.empty() ? "(text)" : file);
  std::shared_ptr<const Scenario> scenario = ScenarioReader(file, robots, by_socket, seed, found).Read(text);
  diagnostics.Append(found);
  return scenario;
}

std::shared_ptr<const Scenario> ReadInsertion(const std::string& text, RobotLibrary& robots,
                                              const Scenario& around, Diagnostics& diagnostics) {
  const std::string label = "(insert)";
  Diagnostics found(label);
  for (const Section& section : ReadSections(text, label, found)) {
    const std::string word = IsNumbered(section.word, "random") ? "random" : section.word;
    for (const char* whole : {"world", "simulation", "floor", "random", "task", "view"}) {
      if (word != whole) continue;
      found.Error({label, section.line}, "[" + section.name +
                                             "] cannot be inserted, only things, robots, swarms, targets and "
                                             "lights: load_scenario loads a whole scenario");
    }
  }
  std::shared_ptr<const Scenario> read;
  if (!found.has_errors()) {
    found = Diagnostics(label);
    ScenarioReader reader(label, robots, true, std::nullopt, found);
    reader.Surround(around);
    read = reader.Read(text);
  }
  diagnostics.Append(found);
  if (read == nullptr) return nullptr;
  auto added = std::make_shared<Scenario>(*read);
  const auto is_around = [](const auto& thing) { return thing.where.file == ScenarioReader::kAround; };
  std::erase_if(added->objects, is_around);
  std::erase_if(added->lights, is_around);
  std::erase_if(added->robots, is_around);
  return added;
}

}  // namespace coopdyn
