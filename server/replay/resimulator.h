// SPDX-License-Identifier: MIT
// Repeats a recorded run from a keyframe on, step by step, with the recorded inputs. Loaded controllers drive
// their robots again: their set-points are computed, not read. One thread, while no other world steps.
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
  /// Repeats the run of `header`, called `file` in messages. `header` and `services` must outlive the
  /// resimulator.
  Resimulator(std::string file, const RunHeader& header, const ReplayServices& services);
  ~Resimulator();

  /// Continues from `state`, a keyframe with scene number `scene` of the file. False, with error() set, if
  /// its world cannot be built, or its controllers are unusable and their set-points were not recorded.
  bool Restore(const SavedStatePtr& state, std::uint64_t scene);
  /// Replaces the inputs for the next steps, in order.
  void SetInputs(std::vector<RunInput> inputs);
  /// Whether `step` is the successor of frame(): in the same scene, or in the next scene if inputs change the
  /// world.
  bool Follows(const RecordedStep& step) const {
    if (step.step != frame()->step + 1) return false;
    return step.scene == scene_number_ || (step.scene == scene_number_ + 1 && ChangesWorld());
  }
  /// Whether the world changes before `step`. @pre Follows().
  bool BeginsScene(const RecordedStep& step) const { return step.scene != scene_number_; }
  /// Runs `step`. False, with error() set, if its content is impossible. @pre Follows().
  bool Step(const RecordedStep& step);
  /// Runs the steps of `reader` up to `step` with their inputs. `check` is called after each step and may
  /// return an error. Returns an error text, empty if frame() is that of `step`.
  std::string StepTo(RunReader& reader, std::uint64_t step,
                     const std::function<std::string(const RecordedStep&)>& check);

  /// Applies the supervisor's changes among `inputs`, the inputs of frame(): the supervisor requested them in
  /// that step and will not request them again.
  void Supervise(std::span<const RunInput> inputs);

  const FramePtr& frame() const { return simulation_->frame(); }
  /// The state to continue from frame(), with the mode in force. Lacks the controllers if they were given up.
  SavedState Save() const;
  /// The recorded set-points in force, by channel. For channels that computes() is true of, valid only if
  /// RecordWhat::controllers was on.
  std::span<const Setpoint> recorded_setpoints() const { return in_force_; }
  /// Whether a loaded controller drives the robot of `channel` in the repetition.
  bool computes(std::size_t channel) const {
    return computed_[static_cast<std::size_t>(frame()->scene->channels[channel].robot)] != 0;
  }
  /// The run has controllers, and they run here too.
  bool has_controllers() const { return host_ != nullptr; }
  /// The controllers are unusable: their actions are read from the recording.
  bool controllers_given_up() const { return controllers_given_up_; }

  const std::string& error() const { return error_; }
  /// Warnings about the result, one per line; empty if none.
  const std::string& warning() const { return warning_; }

 private:
  /// Draws controllers' camera pictures on this thread.
  static DrawPictures DrawHere();
  bool Build(const std::shared_ptr<const Scene>& scene, std::uint64_t seed);
  /// Builds the simulation with the run's controllers; false with `why` if they are unusable.
  bool BuildWithHost(const std::shared_ptr<const Scene>& scene, std::uint64_t seed, std::string& why);
  /// From now on reads the controllers' actions from the recording. `why`: the reason, for the warning.
  bool GiveUpControllers(const std::shared_ptr<const Scene>& scene, std::uint64_t seed,
                         const std::string& why);
  void Apply(const RunInput& input);
  void Change(WorldChange change);
  /// Whether an input for the step after frame() changes the world.
  bool ChangesWorld() const;
  void ListComputed();
  /// Stops the set-points of the robot's channels.
  void StopChannels(std::size_t robot);
  void Warn(const std::string& line);

  const std::string file_;
  const RunHeader& header_;
  const ReplayServices& services_;
  /// Replaces unusable controllers: set-points and broadcasts of their robots are read from the recording,
  /// like those of robots that clients drive.
  ControllerDriver recorded_;
  bool controllers_given_up_ = false;
  std::unique_ptr<ControllerHost> host_;    // null: no controllers are loaded
  std::unique_ptr<Simulation> simulation_;  // declared after the drivers, which it uses
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
  int stopped_here_ = 0;  // controllers that stopped here but not in the run
};

/// A line "controller flock is not the one that was recorded (…)" for each controller of `scene` with another
/// hash in `header`.
std::vector<std::string> OtherPlugins(const RunHeader& header, const Scene& scene);
/// "made by another build (…), with another libode.so.8.0.1, on another processor (…)", as far as `header`
/// differs from this program, and what to do; empty if nothing differs.
std::string OtherOrigin(const RunHeader& header);

}  // namespace coopdyn
