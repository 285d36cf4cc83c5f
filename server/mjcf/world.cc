// SPDX-License-Identifier: MIT
#include "server/mjcf/world.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "server/mjcf/parts.h"
#include "server/mjcf/sdf_text.h"

namespace coopdyn::mjcf {

namespace {

using tinyxml2::XMLElement;

class WorldWriter {
 public:
  WorldWriter(const Source& source, Meshes& meshes)
      : source_(source), m_(source.model()), meshes_(meshes), groups_(static_cast<std::size_t>(m_.nbody)) {}

  std::string Write() {
    XMLElement& root = *document_.InsertEndChild(document_.NewElement("sdf"))->ToElement();
    root.SetAttribute("version", "1.9");
    root.SetAttribute("xmlns:coopdyn", "https://coopdyn.dev/sdf");
    root.SetAttribute("coopdyn:foreign", "true");
    XMLElement& world = AddNamed(root, "world", "mujoco");
    const bool falls = (m_.opt.disableflags & mjDSBL_GRAVITY) == 0;
    Add(world, "gravity", falls ? Numbers(ToVector(m_.opt.gravity)) : "0 0 0");
    XMLElement& physics = AddNamed(world, "physics", "default");
    physics.SetAttribute("type", "ode");
    Add(physics, "max_step_size", Number(m_.opt.timestep));
    ReadEqualities();
    AddScenery(world);
    std::map<int, std::vector<int>> models;  // bodies of each model, by its first root body
    for (int body = 1; body < m_.nbody; ++body) models[GroupOf(m_.body_rootid[body])].push_back(body);
    moving_ =
        static_cast<int>(std::ranges::count_if(models, [&](const auto& one) { return Moves(one.second); }));
    for (const auto& [root_body, bodies] : models) AddModel(root_body, bodies, world);
    SayRest();
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  /// A joint that closes a loop or joins two trees.
  struct Loop {
    std::string name;
    bool is_ball = false;
    int body1 = 0, body2 = 0;
    Vector3 p_B1 = Vector3::Zero();
  };

  int GroupOf(int root) {
    int group = root;
    while (groups_[static_cast<std::size_t>(group)] != 0) group = groups_[static_cast<std::size_t>(group)];
    return group;
  }
  void Join(int body1, int body2) {
    if (body1 == 0 || body2 == 0) return;
    const int a = GroupOf(m_.body_rootid[body1]), b = GroupOf(m_.body_rootid[body2]);
    if (a != b) groups_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  bool Moves(const std::vector<int>& bodies) const {
    return std::ranges::any_of(bodies, [&](int body) { return m_.body_jntnum[body] > 0; });
  }
  bool IsFree(int body) const {
    return m_.body_jntnum[body] > 0 && m_.jnt_type[m_.body_jntadr[body]] == mjJNT_FREE;
  }

  void ReadEqualities() {
    for (int i = 0; i < m_.neq; ++i) {
      if (!m_.eq_active[i]) continue;
      const int one = m_.eq_obj1id[i], other = m_.eq_obj2id[i];
      const mjtNum* const data = m_.eq_data + mjNEQDATA * i;
      if (m_.eq_type[i] == mjEQ_JOINT) {
        ReadJointEquality(one, other, data);
      } else if (m_.eq_type[i] == mjEQ_CONNECT || m_.eq_type[i] == mjEQ_WELD) {
        const bool is_mocap = m_.body_mocapid[one] >= 0 || m_.body_mocapid[other] >= 0;
        if (is_mocap) {
          source_.words().Say("an equality between a body and a mocap body is left out");
          continue;
        }
        const bool is_ball = m_.eq_type[i] == mjEQ_CONNECT;
        loops_.push_back({source_.NameOf(mjOBJ_EQUALITY, i, is_ball ? "connect" : "weld"), is_ball, one,
                          other, is_ball ? ToVector(data) : Vector3::Zero()});
        Join(one, other);
      } else {
        source_.words().Say("an equality of tendons is left out");
      }
    }
  }

  void ReadJointEquality(int one, int other, const mjtNum* data) {
    if (other < 0) {
      if (std::abs(data[0]) < 1e-9)
        couplings_.locked[one] = 0;
      else
        source_.words().Say("an equality that holds a joint away from its initial position is left out");
      return;
    }
    if (data[2] != 0 || data[3] != 0 || data[4] != 0)
      source_.words().Say("only the constant and linear parts of a joint equality are used");
    const bool is_taken = couplings_.followers.contains(one) || couplings_.followers.contains(other);
    const bool leads = std::ranges::any_of(couplings_.followers,
                                           [&](const auto& known) { return known.second.leader == one; });
    if (is_taken || leads || data[1] == 0) {
      source_.words().Say("an equality of joints in a chain of followers is left out");
      return;
    }
    couplings_.followers[one] = {other, data[1], data[0]};
    Join(m_.jnt_bodyid[one], m_.jnt_bodyid[other]);
  }

  /// Adds the geoms of the world body.
  void AddScenery(XMLElement& world) {
    for (int i = 0; i < m_.body_geomnum[0]; ++i) {
      const int geom = m_.body_geomadr[0] + i;
      const bool is_plane = m_.geom_type[geom] == mjGEOM_PLANE;
      if (!is_plane && !source_.Collides(geom)) {
        source_.words().Say("what only decorates the world is left out");
        continue;
      }
      Pose X_WG = ToPose(m_.geom_pos + 3 * geom, m_.geom_quat + 4 * geom);
      const Pose X_GB = X_WG.Inverse();
      X_WG.p.z() -= source_.floor_z_m();
      XMLElement& model = AddNamed(world, "model", FreeName(source_.NameOf(mjOBJ_GEOM, geom, "ground")));
      AddPose(model, X_WG);
      Add(model, "static", "true");
      AddGeom(geom, X_GB, source_, meshes_, AddNamed(model, "link", "link"));
    }
  }

  std::string FreeName(const std::string& wanted) {
    std::string name = wanted;
    for (int i = 2; !names_.insert(name).second; ++i) name = wanted + "_" + std::to_string(i);
    return name;
  }

  void AddModel(int root, const std::vector<int>& bodies, XMLElement& world) {
    const bool moves = Moves(bodies);
    if (!moves && m_.body_mocapid[root] >= 0) {
      source_.words().Say("a mocap body is left out");
      return;
    }
    if (!moves && bodies.size() > 1) {  // each body becomes a model: a model has at most 300 links
      for (const int body : bodies) {
        if (m_.body_geomnum[body] > 0) AddModel(body, {body}, world);
      }
      return;
    }
    std::string name = source_.BodyName(root);
    const std::string given = PlainName(m_.names == nullptr ? "" : m_.names);
    if (moves && moving_ == 1 && !given.empty() && given != "MuJoCo_Model") name = given;
    XMLElement& model = AddNamed(world, "model", FreeName(name));
    Pose X_WM = source_.X_WB(root);
    Pose X_WS = X_WM;  // the start pose
    if (IsFree(root)) {
      if (source_.home() >= 0) {
        const mjtNum* const q = m_.key_qpos + m_.nq * source_.home() + m_.jnt_qposadr[m_.body_jntadr[root]];
        X_WS = ToPose(q, q + 3);
        X_WS.p.z() -= source_.floor_z_m();
      }
    } else {
      X_WM = {{X_WM.p.x(), X_WM.p.y(), 0}, Quaternion::Identity()};
      X_WS = X_WM;
    }
    AddPose(model, X_WS);
    if (!moves) Add(model, "static", "true");
    const Pose X_MW = X_WM.Inverse();
    const bool has_loops = std::ranges::any_of(loops_, [&](const Loop& loop) { return IsOf(loop, bodies); });
    for (const int body : bodies) AddLink(body, X_MW * source_.X_WB(body), source_, meshes_, model);
    if (!moves) return;
    for (const int body : bodies)
      AddJoints(body, X_MW * source_.X_WB(body), couplings_, has_loops, source_, model);
    for (const Loop& loop : loops_) {
      if (IsOf(loop, bodies)) AddLoop(loop, model);
    }
    AddSensors(bodies, source_, model);
    AddThrusters(bodies, source_, model);
  }

  static bool IsOf(const Loop& loop, const std::vector<int>& bodies) {
    const int body = loop.body1 == 0 ? loop.body2 : loop.body1;
    return std::ranges::find(bodies, body) != bodies.end();
  }

  void AddLoop(const Loop& loop, XMLElement& model) {
    const bool turned = loop.body2 == 0;  // the world must be the parent
    XMLElement& joint = AddNamed(model, "joint", loop.name);
    joint.SetAttribute("type", loop.is_ball ? "ball" : "fixed");
    Add(joint, "parent", source_.BodyName(turned ? loop.body2 : loop.body1));
    Add(joint, "child", source_.BodyName(turned ? loop.body1 : loop.body2));
    const Pose X_12 = source_.X_WB(loop.body1).Inverse() * source_.X_WB(loop.body2);
    const Vector3 p_C = turned ? loop.p_B1 : X_12.Inverse() * loop.p_B1;
    Pose X_CJ;
    X_CJ.p = p_C;
    AddPose(joint, X_CJ);
  }

  void SayRest() {
    Words& words = source_.words();
    SaySensors(source_);
    for (int i = 0; i < m_.ntendon; ++i) words.Say("a tendon is left out");
    for (int i = 0; i < m_.nskin; ++i) words.Say("a skin is left out");
    for (int i = 0; i < m_.ncam; ++i) {
      if (m_.cam_bodyid[i] == 0) words.Say("a camera in the world is left out");
    }
    const mjOption& option = m_.opt;
    if (option.density > 0 || option.viscosity > 0)
      words.Say(
          "density and viscosity of <option> are not used: nothing swims, flies or is slowed by the air",
          false);
    if (m_.npair > 0)
      words.Say("the <pair>s of <contact> are left out: geoms collide by their shapes", false);
    for (int joint = 0; joint < m_.njnt; ++joint) {
      if (m_.jnt_type[joint] >= mjJNT_SLIDE && m_.qpos0[m_.jnt_qposadr[joint]] != 0)
        words.Say(
            "a joint with ref counts from the pose in which the model is written: there it is 0, not ref");
    }
  }

  const Source& source_;
  const mjModel& m_;
  Meshes& meshes_;
  tinyxml2::XMLDocument document_;
  std::vector<int> groups_;  // for each root body, the root body that it is joined to; 0 if none
  std::vector<Loop> loops_;
  Couplings couplings_;
  std::set<std::string> names_;
  int moving_ = 0;  // number of moving models
};

}  // namespace

std::string WriteWorld(const Source& source, Meshes& meshes) {
  return WorldWriter(source, meshes).Write();
}

}  // namespace coopdyn::mjcf
