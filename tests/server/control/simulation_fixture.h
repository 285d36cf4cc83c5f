// SPDX-License-Identifier: MIT
// /simulation on the real boards, with a stepping thread that applies edits on demand; no sockets, no
// physics.
#pragma once

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/control/simulation_module.h"
#include "tests/server/base/temp_folder.h"
#include "tests/server/devices/fake_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {

namespace json = boost::json;

class FakeActions final : public ControlActions {
 public:
  void CloseClient(const std::string& robot, ClientId client, const std::string& reason) override {
    closed.push_back(robot + " " + std::to_string(client) + " " + reason);
  }
  void Quit() override { ++quits; }
  std::string recording() const override { return "night.run"; }
  std::string http() const override { return ""; }

  std::vector<std::string> closed;
  int quits = 0;
};

class SimulationModuleTest : public testing::Test {
 protected:
  SimulationModuleTest() {
    Write("hall.scenario", "[FLOOR]\nsize 8 8 0.1\n");
    Write("broken.scenario", "[FLOOR]\nsize 8 banana 0.1\n");
    run_.SetStatus(RunStatus{});
    module_.emplace(services_, thread_.poster());
    client_.emplace(*module_, 1);
  }
  ~SimulationModuleTest() override {
    client_.reset();
    module_.reset();
  }

  void Write(const std::string& name, const std::string& text) { folder_.Write(name, text); }

  /// Runs the pending loads, as the thread that reads scenarios does.
  void RunLoads() {
    for (const auto& load : std::exchange(loads_, {})) load();
  }
  /// Answers every edit, as the stepping thread does, and keeps it.
  void ApplyEdits() {
    for (Edit& each : edits_.TakeAll()) {
      EditResult result = next_result_;
      if (const auto* load = As<edit::Load>(each.action); load && result.error == Error::kOk) {
        world_.Load(load->scenario, Mode::kLockstep);
      }
      if (As<edit::Reset>(each.action) != nullptr) {
        world_.Load(SmallScenario(2), Mode::kLockstep, StepEnd::kReset);
      }
      if (const auto* participants = As<edit::SetParticipants>(each.action)) {
        const Verdict verdict = world_.board.SetParticipants(participants->names, 0);
        result.error = verdict.error;
        result.text = verdict.text;
      }
      if (const auto* step = As<edit::Step>(each.action); step && result.error == Error::kOk) {
        world_.board.WaitSteps(step->steps, each.stepped);
        applied_.push_back(std::move(each.action));
        continue;
      }
      result.frame = world_.frames.Latest();
      each.done(result);
      applied_.push_back(std::move(each.action));
    }
    thread_.Run();
  }
  /// Sends a line, applies its edit, returns the reply.
  Message Ask(const std::string& line) {
    client_->Send(line);
    RunLoads();
    ApplyEdits();
    EXPECT_FALSE(client_->is_waiting()) << line;
    return client_->received.back();
  }
  template <typename T>
  const T& LastEdit() {
    return *As<T>(applied_.back());
  }
  json::object Status(const std::string& line = "get_status") {
    return json::parse(Ask(line).text).as_object();
  }

  const TempFolder folder_;
  ManualClock clock_;
  NameTable names_;
  ConnectionRoster roster_;
  TokenGuard guard_{"secret", true};
  RobotLibrary robots_{SearchPath{{folder_.path()}}};
  Doorbell bell_;
  EditQueue edits_{bell_};
  RunControl run_;
  FakeActions actions_;
  SmallWorld world_{2};
  std::vector<std::string> applied_scenes_;
  std::function<void()> serve_;  // called when the robots of the newest load serve
  SimulationServices services_{{world_.board, world_.frames, edits_, roster_, guard_, clock_, "1.2.3",
                                [this](const auto& scene, std::function<void()> done) {
                                  applied_scenes_.push_back(scene->scenario->name);
                                  serve_ = std::move(done);
                                  if (serve_at_once_) serve_();
                                }},
                               run_,
                               names_,
                               robots_,
                               actions_,
                               [this](std::function<void()> load) { loads_.push_back(std::move(load)); }};
  std::vector<std::function<void()>> loads_;  // posted to the thread that reads scenarios
  FakeThread thread_;
  EditResult next_result_;
  bool serve_at_once_ = true;
  std::vector<EditAction> applied_;
  std::optional<SimulationModule> module_;
  std::optional<FakeClient> client_;
};

}  // namespace coopdyn
