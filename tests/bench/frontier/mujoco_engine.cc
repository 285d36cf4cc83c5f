// SPDX-License-Identifier: MIT
#include <mujoco/mujoco.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "tests/bench/frontier/engine.h"

namespace coopdyn::frontier {
namespace {

std::string Text(const Vector3& v) {
  std::ostringstream out;
  out.precision(17);
  out << '"' << v.x() << ' ' << v.y() << ' ' << v.z() << '"';
  return out.str();
}

/// One body and its children, as MJCF.
void Write(const Setup& setup, std::size_t i, std::ostream& out) {
  const Body& body = setup.bodies[i];
  const bool in_tree = !setup.joints.empty();
  const Joint joint = in_tree ? setup.joints[i] : Joint{Joint::Kind::kFree};
  const Vector3 parent_W =
      joint.parent < 0 ? Vector3::Zero() : setup.bodies[static_cast<std::size_t>(joint.parent)].X_W.p;
  const Quaternion& q = body.X_W.q;
  out << "<body name=\"b" << i << "\" pos=" << Text(body.X_W.p - parent_W) << " quat=\"" << q.w() << ' '
      << q.x() << ' ' << q.y() << ' ' << q.z() << "\">\n";
  if (body.mass_kg > 0) {
    out << "<inertial pos=\"0 0 0\" mass=\"" << body.mass_kg << "\" diaginertia=" << Text(InertiaOf(body))
        << "/>\n";
    if (joint.kind == Joint::Kind::kFree) {
      out << "<freejoint/>\n";
    } else {
      const char* type = joint.kind == Joint::Kind::kBall     ? "ball"
                         : joint.kind == Joint::Kind::kSlider ? "slide"
                                                              : "hinge";
      out << "<joint type=\"" << type << "\" pos=" << Text(joint.p_W - body.X_W.p)
          << " axis=" << Text(joint.axis_W) << " stiffness=\"" << joint.stiffness << "\" damping=\""
          << joint.damping << "\" springref=\"" << joint.rest << "\"/>\n";
    }
  }
  if (!in_tree) {
    const bool is_box = std::holds_alternative<Box>(body.shape);
    // The friction of the moving body counts, as in the other engines.
    out << "<geom type=\"" << (is_box ? "box" : "sphere") << "\" size=" << Text(SizeOf(body) / 2)
        << " friction=\"" << body.friction << "\" priority=\"" << (body.mass_kg > 0) << "\"/>\n";
  }
  for (std::size_t child = i + 1; in_tree && child < setup.bodies.size(); ++child) {
    if (setup.joints[child].parent == static_cast<int>(i)) Write(setup, child, out);
  }
  out << "</body>\n";
}

std::string Mjcf(const Setup& setup, double step_s, const std::string& integrator) {
  std::ostringstream out;
  out.precision(17);
  out << "<mujoco>\n<compiler angle=\"radian\"/>\n<option timestep=\"" << step_s << "\" integrator=\""
      << integrator << "\" gravity=\"0 0 " << -setup.gravity_m_s2 << "\"/>\n<worldbody>\n";
  if (setup.joints.empty()) out << "<geom type=\"plane\" size=\"0 0 1\" priority=\"0\"/>\n";
  for (std::size_t i = 0; i < setup.bodies.size(); ++i) {
    if (setup.joints.empty() || setup.joints[i].parent < 0) Write(setup, i, out);
  }
  out << "</worldbody>\n</mujoco>\n";
  return out.str();
}

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};

class Mujoco : public Engine {
 public:
  Mujoco(const Setup& setup, double step_s, const std::string& integrator) {
    mju_user_warning = [](const char*) {};  // it would write a file; Motions() checks instead
    char file[] = "/tmp/frontier-XXXXXX";
    if (mkstemp(file) < 0) throw std::runtime_error("no temporary file");
    std::ofstream(file) << Mjcf(setup, step_s, integrator);
    std::array<char, 1000> error{};
    model_.reset(mj_loadXML(file, nullptr, error.data(), static_cast<int>(error.size())));
    std::remove(file);
    if (!model_) throw std::runtime_error(error.data());
    data_.reset(mj_makeData(model_.get()));
    for (std::size_t i = 0; i < setup.bodies.size(); ++i) {
      const Body& body = setup.bodies[i];
      ids_.push_back(mj_name2id(model_.get(), mjOBJ_BODY, ("b" + std::to_string(i)).c_str()));
      if (body.mass_kg <= 0) continue;
      const auto kind = setup.joints.empty() ? Joint::Kind::kFree : setup.joints[i].kind;
      mjtNum* velocity = data_->qvel + model_->body_dofadr[ids_.back()];
      const Vector3 w_B = body.X_W.q.conjugate() * body.w_W;
      if (kind == Joint::Kind::kFree) {
        for (int k = 0; k < 3; ++k) velocity[k] = body.v_W[k], velocity[3 + k] = w_B[k];
      } else if (kind == Joint::Kind::kBall) {
        for (int k = 0; k < 3; ++k) velocity[k] = w_B[k];
      }
    }
  }

  void Run(int steps) override {
    for (int i = 0; i < steps; ++i) mj_step(model_.get(), data_.get());
  }

  std::vector<Motion> Motions() override {
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_fwdVelocity(model_.get(), data_.get());
    bool exploded = false;  // or it dropped contacts for lack of space
    for (const int kind :
         {mjWARN_CONTACTFULL, mjWARN_CNSTRFULL, mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC}) {
      exploded = exploded || data_->warning[kind].number > 0;
    }
    std::vector<Motion> motions;
    for (const int id : ids_) {
      const mjtNum *p = data_->xpos + 3 * id, *q = data_->xquat + 4 * id;
      std::array<mjtNum, 6> rates{};
      mj_objectVelocity(model_.get(), data_.get(), mjOBJ_BODY, id, rates.data(), 0);
      motions.push_back({{p[0], p[1], p[2]},
                         {q[0], q[1], q[2], q[3]},
                         {rates[3], rates[4], rates[5]},
                         {rates[0], rates[1], rates[2]}});
      if (exploded) motions.back().p_W.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    return motions;
  }

 private:
  std::unique_ptr<mjModel, DeleteModel> model_;
  std::unique_ptr<mjData, DeleteData> data_;
  std::vector<int> ids_;
};

}  // namespace

std::string MujocoVersion() {
  return mj_versionString();
}

std::vector<std::string> MujocoIntegrators() {
  if (mj_version() < 235) return {"Euler", "implicit", "RK4"};
  return {"Euler", "implicitfast", "implicit", "RK4"};
}

std::unique_ptr<Engine> MakeMujoco(const Setup& setup, double step_s, const std::string& integrator) {
  return std::make_unique<Mujoco>(setup, step_s, integrator);
}

}  // namespace coopdyn::frontier
