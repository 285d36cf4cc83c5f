// SPDX-License-Identifier: MIT
// Runs a recorded run once more: from a keyframe on, step by step, with the recorded inputs. Robots that a
// loaded controller drove are driven by it again, so that its set-points are computed, not read. One thread,
// and no other world steps meanwhile.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/controllers/controller_host.h"
#include "server/physics/simulation.h"
#include "server/record/run_header.h"
#include "server/replay/state_at.h"
#include "server/state/controller_driver.h"

namespace coopdyn {

class Resimulator {
 public:
  /// Repeats a run of `header`, called `file` in texts. `services` outlives it.
  Resimulator(std::string file, const RunHeader& header, const ReplayServices& services);
  ~Resimulator();

  /// Goes on from `state`, a keyframe with scene number `scene` of the file. False, and error() says why, if
  /// its world cannot be built, or its controllers were not found and their set-points were not recorded.
  bool Restore(const SavedStatePtr& state, std::uint64_t scene);
  /// Inputs of the run for the steps to come, in their order, instead of those given before.
  void SetInputs(std::vector<RunInput> inputs);
  /// Whether `step` is the one after frame(): in the same scene, or in the next one if inputs change the
  /// world.
  bool Follows(const RecordedStep& step) const {
    if (step.step != frame()->step + 1) return false;
    return step.scene == scene_number_ || (step.scene == scene_number_ + 1 && ChangesWorld());
  }
  /// Whether the world is changed before `step`, which follows.
  bool BeginsScene(const RecordedStep& step) const { return step.scene != scene_number_; }
  /// Runs `step`. @pre Follows(). False, and error() says why, if what it says cannot be.
  bool Step(const RecordedStep& step);
  /// Runs the steps of `reader` up to `step`, with their inputs. An error text, empty if frame() is that of
  /// `step`; `check`, called after each step, may give one, too.
  std::string StepTo(RunReader& reader, std::uint64_t step,
                     const std::function<std::string(const RecordedStep&)>& check);

  /// Makes the supervisor's changes among `inputs`, those of frame(): it has asked for them in that step, and
  /// does not do so again.
  void Supervise(std::span<const RunInput> inputs);

  const FramePtr& frame() const { return simulation_->frame(); }
  /// What goes on from frame(), with the mode in force then. The controllers are missing from it if they are
  /// given up.
  SavedState Save() const;
  /// By channel: the set-points in force as the recording has them. Those of robots with computed() are there
  /// only if RecordWhat::controllers was on.
  std::span<const Setpoint> recorded_setpoints() const { return in_force_; }
  /// A loaded controller drives the robot of this channel here.
  bool computes(std::size_t channel) const {
    return computed_[static_cast<std::size_t>(frame()->scene->channels[channel].robot)] != 0;
  }
  /// There are controllers, and they are those of the run.
  bool has_controllers() const { return host_ != nullptr; }
  /// They cannot be used: what they did is taken from the recording.
  bool controllers_given_up() const { return controllers_given_up_; }

  const std::string& error() const { return error_; }
  /// What a reader of the result must know; lines, empty if there is nothing.
  const std::string& warning() const { return warning_; }

 private:
  /// Draws what controllers see on this thread.
  static DrawPictures DrawHere();
  bool Build(const std::shared_ptr<const Scene>& scene, std::uint64_t seed);
  /// The controllers of the run; false with `why` if they cannot be used.
  bool BuildWithHost(const std::shared_ptr<const Scene>& scene, std::uint64_t seed, std::string& why);
  /// Takes what controllers did from the recording from now on. `why`: they cannot be used.
  bool GiveUpControllers(const std::shared_ptr<const Scene>& scene, std::uint64_t seed,
                         const std::string& why);
  void Apply(const RunInput& input);
  void Change(WorldChange change);
  /// An input for the step after frame() changes what stands in the world.
  bool ChangesWorld() const;
  void ListComputed();
  /// The robot's channels come to rest.
  void StopChannels(std::size_t robot);
  void Warn(const std::string& line);

  const std::string file_;
  const RunHeader& header_;
  const ReplayServices& services_;
  /// Replaces loaded controllers that were not found: then the set-points and broadcasts of their robots are
  /// taken from the recording, as those of clients' robots are.
  ControllerDriver recorded_;
  bool controllers_given_up_ = false;
  std::unique_ptr<ControllerHost> host_;    // null: none are loaded
  std::unique_ptr<Simulation> simulation_;  // after the drivers, which it uses
  std::uint64_t scene_number_ = 0;          // in the file
  Mode mode_ = Mode::kRealtime;
  bool paused_ = false;
  std::vector<RunInput> inputs_;
  std::size_t next_input_ = 0;
  std::vector<Setpoint> in_force_, latched_;  // by channel
  std::vector<std::uint8_t> commanded_;       // by actuator
  std::vector<std::uint8_t> computed_;        // by robot
  std::vector<SentMessage> messages_;
  std::string error_, warning_;
  int stopped_here_ = 0;  // controllers that did not stop in the run
};

/// "controller flock is not the one that was recorded (…)": a line for each of `scene` of which `header` has
/// another hash.
std::vector<std::string> OtherPlugins(const RunHeader& header, const Scene& scene);
/// "made by another build (…), with another libode.so.8.0.1, on another processor (…)", as far as `header`
/// says so, and what to do; else empty.
std::string OtherOrigin(const RunHeader& header);

}  // namespace coopdyn
