// SPDX-License-Identifier: MIT
#include "server/model/gazebo_plugins.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "server/model/text_file.h"
#include "server/model/values.h"
#include "server/model/yarp_ini.h"

namespace coopdyn {

namespace {

bool HasWord(const std::string& text, std::string_view word) {
  return text.find(word) != std::string::npos;
}

/// Lower case, without - and _.
std::string Plain(const std::string& text) {
  std::string plain = ToLower(text);
  std::erase_if(plain, [](char c) { return c == '-' || c == '_'; });
  return plain;
}

/// How a model behaves differently without a plugin; empty if unknown.
std::string WhyItMatters(const XmlNode& plugin) {
  const std::string word = PluginWord(plugin);
  if (word == "trackedvehicle" || word == "trackcontroller")
    return "its tracks do not move, and nothing drives them; wheels with a DiffDrive would";
  if (word == "detachablejoint")
    return "the model '" + plugin.TextOf("child_model") +
           "' is not attached, and moves on its own; for the whole run a link with <joint type=\"fixed\"> "
           "would hold it";
  if (word == "liftdrag" || word == "advancedliftdrag" || word == "liftdragplugin")
    return "air and water do not push wings and fins, so planes do not fly and rudders do not steer";
  if (word == "buoyancy" || word == "hydrodynamics" || word == "buoyancyengine")
    return "no water carries or slows anything: set gravity 0 in the scenario for floating things";
  if (word == "windeffects") return "no wind blows";
  if (word == "planarmove" || word == "velocitycontrol" || word == "trajectoryfollower")
    return "it moves a model without wheels or forces; thrusters would push it";
  return {};
}

/// The first non-empty text of these elements.
std::string FirstOf(const XmlNode& node, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (!node.TextOf(name).empty()) return node.TextOf(name);
  }
  return {};
}

std::string JoinWords(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

class PluginTranslator {
 public:
  PluginTranslator(const Resources* resources, XmlNode& model, NeedlessPlugins& needless,
                   Diagnostics& diagnostics)
      : resources_(resources), model_(model), needless_(needless), diagnostics_(diagnostics) {}

  void Translate(const std::vector<GazeboPlugin>& plugins) {
    for (const GazeboPlugin& plugin : plugins) TranslateOne(plugin);
    AddYarpBoards();
    needless_.Say(diagnostics_);
    for (const auto& [file, unused] : unused_) LeaveOutPlugin(*unused.first, unused.second, diagnostics_);
  }

 private:
  void Warn(const GazeboPlugin& plugin, std::string text) {
    diagnostics_.Warning(plugin.node.where, std::move(text));
  }

  XmlNode& Add(const GazeboPlugin& plugin, const char* element) {
    XmlNode& added = model_.Add(element);
    added.where = plugin.node.where;
    return added;
  }

  /// The joints in elements with these names, in order, with the prefix of their model.
  static std::vector<std::string> JointsOf(const GazeboPlugin& plugin,
                                           std::initializer_list<std::string_view> names) {
    std::vector<std::string> joints;
    for (const XmlNode& child : plugin.node.children) {
      if (std::ranges::find(names, child.name) != names.end() && !child.text.empty())
        joints.push_back(plugin.scope + child.text);
    }
    return joints;
  }

  void TranslateOne(const GazeboPlugin& plugin) {
    const std::string file = ToLower(plugin.node.Attribute("filename"));
    if (PluginWord(plugin.node) == "controlboard" && HasWord(file, "yarp")) return ReadYarpBoard(plugin);
    if (needless_.Take(plugin.node)) return;
    // In Gazebo Classic, either file name or name may identify the plugin.
    const std::string word = Plain(file + " " + plugin.node.Attribute("name"));
    if (AddDrive(plugin, word) || AddMecanum(plugin, word) || AddRotor(plugin, word) ||
        AddJoints(plugin, word))
      return;
    // Its joints are in <ros2_control> or in <transmission>s.
    const bool is_ros = HasWord(file, "ros_control") || HasWord(file, "ros2_control");
    if (is_ros && model_.Child("coopdyn:gazebo_joint") != nullptr) return;
    auto& [first, count] = unused_[plugin.node.Attribute("filename") + WhyItMatters(plugin.node)];
    if (count++ == 0) first = &plugin.node;
  }

  bool AddDrive(const GazeboPlugin& plugin, const std::string& word) {
    constexpr const char* kWords[] = {"diffdrive", "differentialdrive", "ackermann", "skidsteer"};
    if (std::ranges::none_of(kWords, [&word](const char* one) { return HasWord(word, one); })) return false;
    const auto left =
        JointsOf(plugin, {"left_joint", "leftJoint", "rear_left_joint", "leftFrontJoint", "leftRearJoint",
                          "left_front", "left_rear", "left_front_joint", "left_rear_joint"});
    const auto right = JointsOf(
        plugin, {"right_joint", "rightJoint", "rear_right_joint", "rightFrontJoint", "rightRearJoint",
                 "right_front", "right_rear", "right_front_joint", "right_rear_joint"});
    if (left.empty() || right.empty()) return false;
    if (model_.Child("coopdyn:gazebo_drive") != nullptr) {
      diagnostics_.LeftOut(plugin.node.where, "a second differential drive");
      return true;
    }
    XmlNode& drive = Add(plugin, "coopdyn:gazebo_drive");
    drive.Set("left_joint", left.front());
    drive.Set("right_joint", right.front());
    drive.Set("other_left_joints", JoinWords({left.begin() + 1, left.end()}));
    drive.Set("other_right_joints", JoinWords({right.begin() + 1, right.end()}));
    for (const auto& [key, joints] : {std::pair("steer_left", JointsOf(plugin, {"left_steering_joint"})),
                                      std::pair("steer_right", JointsOf(plugin, {"right_steering_joint"}))}) {
      if (!joints.empty()) drive.Set(key, joints.front());
    }
    for (const auto& [key, text] :
         {std::pair("steering_limit", FirstOf(plugin.node, {"steering_limit", "max_steer"})),
          std::pair("torque", FirstOf(plugin.node, {"max_wheel_torque", "wheelTorque", "torque"})),
          std::pair("diameter", FirstOf(plugin.node, {"wheel_diameter", "wheelDiameter"})),
          std::pair("radius", FirstOf(plugin.node, {"wheel_radius"}))}) {
      if (!text.empty()) drive.Set(key, text);
    }
    return true;
  }

  /// Makes a group of the four wheels. Clients apply the formula (docs/models.md).
  bool AddMecanum(const GazeboPlugin& plugin, const std::string& word) {
    if (!HasWord(word, "mecanum")) return false;
    std::vector<std::string> wheels;
    for (const auto& names : {std::initializer_list<std::string_view>{"front_left_joint"},
                              {"front_right_joint"},
                              {"back_left_joint", "rear_left_joint"},
                              {"back_right_joint", "rear_right_joint"}}) {
      for (const std::string& joint : JointsOf(plugin, names)) wheels.push_back(joint);
    }
    if (wheels.size() != 4) return false;
    AddGroup(plugin, "wheels", wheels);
    diagnostics_.Note(plugin.node.where,
                      "the Mecanum drive is the group 'wheels' (front left, front right, back left, back "
                      "right): docs/models.md has their speeds for a velocity; their <fdir1> makes the "
                      "rollers");
    return true;
  }

  void AddGroup(const GazeboPlugin& plugin, const std::string& name, const std::vector<std::string>& joints) {
    for (const std::string& joint : joints) Add(plugin, "coopdyn:gazebo_joint").Set("joint", joint);
    XmlNode& group = Add(plugin, "coopdyn:gazebo_group");
    group.Set("name", name);
    group.Set("joints", JoinWords(joints));
  }

  /// Makes a thruster along the axis of a propeller. The propeller's reaction torque turns its holder.
  bool AddRotor(const GazeboPlugin& plugin, const std::string& word) {
    const bool is_motor = HasWord(word, "motormodel") && !HasWord(word, "generic");
    const bool is_jet = HasWord(word, "spacecraftthruster");
    const auto joints = JointsOf(plugin, {"jointName", "joint_name"});
    const auto links = JointsOf(plugin, {"linkName", "link_name"});
    if (is_jet ? links.empty() : !(is_motor || PluginWord(plugin.node) == "thruster") || joints.empty())
      return false;
    if (is_motor && plugin.node.TextOf("motorType") == "position") return false;
    // Defaults of the plugins.
    const auto number = [&plugin](const char* key, double otherwise) {
      return ParsePlain(plugin.node.TextOf(key)).value_or(otherwise);
    };
    XmlNode& rotor = Add(plugin, "coopdyn:gazebo_rotor");
    if (!joints.empty()) rotor.Set("joint", joints.front());
    if (!links.empty() && (is_motor || is_jet)) rotor.Set("link", links.front());
    if (!is_motor) {
      rotor.Set("max_force_n",
                FormatNumber(is_jet ? number("max_thrust", 0) : number("max_thrust_cmd", 1000)));
      return true;
    }
    const double fastest_rad_s = number("maxRotVelocity", 838),
                 thrust_n_s2 = number("motorConstant", 8.54858e-6);
    const double turning = plugin.node.TextOf("turningDirection") == "ccw" ? 1 : -1;
    rotor.Set("max_force_n", FormatNumber(thrust_n_s2 * fastest_rad_s * fastest_rad_s));
    rotor.Set("torque_per_force_m", FormatNumber(-turning * number("momentConstant", 0.016)));
    const bool drags = number("rotorDragCoefficient", 0) != 0 || number("rollingMomentCoefficient", 0) != 0;
    if (drags && !std::exchange(says_drag_, true))
      Warn(plugin,
           "<rotorDragCoefficient> and <rollingMomentCoefficient> are not used by coopdyn: the air does "
           "not slow the flight");
    return true;
  }

  /// Appends the joints of `model` with one axis whose names begin with `wanted`. `scope`: prefix of the
  /// model's names.
  static void AddJointsIn(const XmlNode& model, const std::string& scope, const std::string& wanted,
                          std::vector<std::string>& joints) {
    constexpr std::string_view kWithMotor[] = {"revolute", "continuous", "prismatic", "screw"};
    for (const XmlNode& child : model.children) {
      const std::string name = scope + child.Attribute("name");
      if (child.name == "model") AddJointsIn(child, name + "::", wanted, joints);
      if (child.name != "joint" || !name.starts_with(wanted)) continue;
      if (std::ranges::find(kWithMotor, child.Attribute("type")) != std::end(kWithMotor))
        joints.push_back(name);
    }
  }

  bool AddJoints(const GazeboPlugin& plugin, const std::string& word) {
    constexpr const char* kWords[] = {"jointpositioncontroller", "jointcontroller", "jointposition",
                                      "jointposetrajectory",     "jointtrajectory", "applyjointforce"};
    if (std::ranges::none_of(kWords, [&word](const char* one) { return HasWord(word, one); })) return false;
    auto joints = JointsOf(plugin, {"joint_name", "jointName", "joint"});
    if (joints.empty() && HasWord(word, "jointtrajectory")) AddJointsIn(model_, "", plugin.scope, joints);
    const std::string effort = plugin.node.TextOf("cmd_max");
    for (const std::string& joint : joints) {
      XmlNode& moved = Add(plugin, "coopdyn:gazebo_joint");
      moved.Set("joint", joint);
      if (!effort.empty()) moved.Set("effort", effort);
    }
    return !joints.empty();
  }

  void ReadYarpBoard(const GazeboPlugin& plugin) {
    constexpr std::size_t kMostBoards = 100, kMostBytes = 1u << 20;
    const std::string uri = plugin.node.TextOf("yarpConfigurationFile");
    const auto leave = [&](const std::string& why) {
      Warn(plugin, "the control board of '" + uri +
                       "' is left out, and its joints are in the group 'joints': " + why);
    };
    if (plugin.node.Child("initialConfiguration") != nullptr)
      Warn(plugin, "<initialConfiguration> is not used by coopdyn: joints start as the model is written");
    if (inis_.size() >= kMostBoards) return leave("a robot has at most 100");
    std::string why = "this model came without its files";
    const auto file =
        resources_ == nullptr ? std::nullopt : resources_->Find(uri, plugin.node.where.file, why);
    if (!file) return leave(why);
    std::error_code error;
    if (!std::filesystem::is_regular_file(*file, error) ||
        std::filesystem::file_size(*file, error) > kMostBytes)
      return leave("it is no file of at most 1 MiB");
    Diagnostics found;
    const auto text = ReadTextFile(file->string(), plugin.node.where, found);
    if (!text) return leave("it is no text");
    inis_.push_back(ParseYarpIni(*text));
    boards_.push_back(&plugin);
  }

  void AddYarpBoards() {
    std::vector<std::string> left_out;
    for (const YarpBoard& board : YarpBoardsOf(inis_, left_out)) {
      const GazeboPlugin& plugin = *boards_[board.ini];
      std::vector<std::string> joints;
      for (const std::string& joint : board.joints) joints.push_back(plugin.scope + joint);
      AddGroup(plugin, board.name, joints);
    }
    if (left_out.empty()) return;
    diagnostics_.Warning(boards_.front()->node.where,
                         "control boards that have no joints are left out, as wider boards have these, or no "
                         "<yarpConfigurationFile> names any: " +
                             JoinWords(left_out));
  }

  const Resources* resources_;
  XmlNode& model_;
  NeedlessPlugins& needless_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::pair<const XmlNode*, int>> unused_;  // first plugin of each kind, and count
  bool says_drag_ = false;
  std::vector<YarpIni> inis_;
  std::vector<const GazeboPlugin*> boards_;  // parallel to inis_
};

}  // namespace

std::string PluginWord(const XmlNode& plugin) {
  std::string word = plugin.Attribute("name");
  const std::size_t scope = word.rfind("::");
  word = ToLower(scope == std::string::npos ? plugin.Attribute("filename") : word.substr(scope + 2));
  word.erase(0, word.find_last_of('/') + 1);
  for (const std::string_view end : {".so", "-system"}) {
    if (word.ends_with(end)) word.resize(word.size() - end.size());
  }
  for (const std::string_view start :
       {"lib", "gz-sim-", "gz-sim", "ignition-gazebo-", "gazebo_ros_", "gazebo_yarp_", "gazebo_", "yarp-"}) {
    if (word.starts_with(start)) word.erase(0, start.size());
  }
  return Plain(word);
}

void LeaveOutPlugin(const XmlNode& plugin, int count, Diagnostics& diagnostics) {
  diagnostics.LeftOut(plugin.where, "plug-in '" + plugin.Attribute("filename") + "'", count,
                      WhyItMatters(plugin));
}

bool NeedlessPlugins::Take(const XmlNode& plugin) {
  static constexpr const char* kWords[] = {
      // Gazebo's.
      "physics", "physicssystem", "usercommands", "scenebroadcaster", "jointstatepublisher",
      "odometrypublisher", "posepublisher", "logrecord",
      // Plugins that enable <sensor>s.
      "sensors", "imu", "contact", "forcetorque", "magnetometer", "altimeter", "airpressure", "airspeed",
      "navsat", "imusensor", "raysensor", "laser", "gpulaser", "blocklaser", "camera", "depthcamera",
      "multicamera", "openninikinect", "opennikinect", "bumper", "ftsensor", "range",
      // ROS's and YARP's: in coopdyn every module has a socket.
      "p3d", "init", "factory", "state", "apiplugin", "robotinterface", "worldinterface", "clock",
      "lasersensor", "jointsensors", "basestate"};
  const std::string word = PluginWord(plugin);
  if (std::ranges::count(kWords, word) == 0) return false;
  const std::string name = plugin.Attribute("name"), file = plugin.Attribute("filename");
  const std::string shown = name.find("::") != std::string::npos || file.empty() ? name : file;
  if (words_.empty()) first_ = plugin.where;
  if (std::ranges::count(words_, shown) == 0) words_.push_back(shown);
  return true;
}

void NeedlessPlugins::Say(Diagnostics& diagnostics) const {
  if (words_.empty()) return;
  std::string all;
  for (const std::string& word : words_) all += (all.empty() ? "" : ", ") + word;
  diagnostics.Note(first_,
                   "what these plug-ins give is there anyway, sensors as their <sensor> says: " + all);
}

void TranslatePlugins(const std::vector<GazeboPlugin>& plugins, const Resources* resources, XmlNode& model,
                      NeedlessPlugins& needless, Diagnostics& diagnostics) {
  PluginTranslator(resources, model, needless, diagnostics).Translate(plugins);
}

}  // namespace coopdyn
