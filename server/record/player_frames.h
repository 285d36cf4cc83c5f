// SPDX-License-Identifier: MIT
// Makes frames from a recording: recorded poses and channels (nan if they were not recorded), velocities from
// the difference to the previous poses, and the set-points and broadcasts in force. The first step has an
// exact state and so its exact velocities. One thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/record/run_reader.h"
#include "server/state/frame_pool.h"

namespace coopdyn {

/// The commands and broadcasts of a recorded run at any of its steps: set-points carry over from the
/// preceding keyframe. Moving forwards or backwards a little is cheap; a jump reads the steps since that
/// keyframe.
class PlayInputs {
 public:
  explicit PlayInputs(RunReader& reader) : reader_(reader) {}

  /// Moves to `step`, which is recorded. False, with the reader's error() set, if the file is damaged.
  bool GoTo(std::uint64_t step);

  // All below describe the step of the last GoTo().
  /// A channel's set-point in force, and whether a client's set-point came into force with this step.
  struct Driven {
    Setpoint setpoint;
    bool commanded = false;
  };
  /// In the order of scene->channels.
  std::span<const Driven> channels() const { return channels_; }
  /// Messages that a robot may still hear: sent within the longest message delay of the scene's robots, this
  /// step included.
  std::vector<SentMessage> Messages() const;
  /// The newest keyframe at or before the step: seed and solver seed; the exact state if it is the step's
  /// own.
  const Frame& keyframe() const { return *keyframe_->frame; }

 private:
  /// The inputs of one step, or a new scene.
  struct Inputs {
    std::uint64_t step = 0;
    std::shared_ptr<const Scene> scene;
    std::vector<CommandRecord> commands;
    std::vector<SentMessage> messages;
  };

  bool Load(std::uint64_t step);
  /// Reads the steps up to `step`. Sets `gap` if steps in between were left out.
  bool ReadOn(std::uint64_t step, bool& gap);
  void Replay(std::uint64_t step);
  /// Switches to `scene`: each robot keeps its set-points.
  void Enter(const std::shared_ptr<const Scene>& scene);

  RunReader& reader_;
  SavedStatePtr keyframe_;
  std::uint64_t limit_ = 0;             // beyond this many steps from the keyframe, look for a newer one
  std::uint64_t newest_ = 0;            // steps after the keyframe have been read up to here
  std::vector<Inputs> inputs_;          // of the steps read, those that have any
  std::uint64_t step_ = 0;              // of the last GoTo()
  std::size_t next_ = 0;                // index of the first inputs after step_
  std::shared_ptr<const Scene> scene_;  // of step_
  std::vector<Driven> channels_;        // of scene_
  std::shared_ptr<const Scene> newest_scene_;
};

class PlayFrames {
 public:
  explicit PlayFrames(RunReader& reader) : reader_(reader), inputs_(reader) {}

  /// The frame of `step`, which has poses. Null, with the reader's error() set, if the file is damaged.
  std::shared_ptr<Frame> Make(std::uint64_t step);

 private:
  /// The frame without sensor samples.
  std::shared_ptr<Frame> MakeMoment(std::uint64_t step);
  /// The newest step with poses at or before `step`, for sensors; null if there is none.
  FramePtr MomentAt(std::uint64_t step);
  /// Fills in the samples of sensors with a rate or a delay.
  void AddSamples(Frame& frame);
  std::optional<RecordedStep> Read(std::uint64_t step);
  /// Fills in the target of a control board's joint; its trajectory was not recorded.
  static void ShowAim(const ChannelState& channel, JointControl& control);
  /// Fills in the velocities of the bodies of `frame`; false if the file is damaged.
  bool AddVelocities(const RecordedStep& now, Frame& frame);

  RunReader& reader_;
  PlayInputs inputs_;
  FramePool pool_;
  std::vector<FramePtr> moments_;       // for samples; most recently used last
  std::optional<RecordedStep> newest_;  // made last; usually the previous step
};

/// The angular velocity, rad/s in the world, that turns `from` into `to` within `seconds` along the shorter
/// arc.
Vector3 AngularVelocity(const Quaternion& from, const Quaternion& to, double seconds);

}  // namespace coopdyn
