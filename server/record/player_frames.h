// SPDX-License-Identifier: MIT
// Makes frames of a recording: recorded poses and channels (nan if they were not recorded), velocities from
// the difference to the poses before, set-points and broadcasts as they were in force. Of the first step,
// whose exact state is there, the exact velocities. One thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/record/run_reader.h"
#include "server/state/frame_pool.h"

namespace coopdyn {

/// What was commanded and sent in a recorded run, at any of its steps: set-points in force are carried on
/// from the keyframe before. Going on, forwards or backwards, costs little; a jump reads the steps since that
/// keyframe.
class PlayInputs {
 public:
  explicit PlayInputs(RunReader& reader) : reader_(reader) {}

  /// Goes to `step`, which is recorded. False, and the reader's error() says why, if the file is damaged.
  bool GoTo(std::uint64_t step);

  // Of the step gone to.
  /// The set-point in force of a channel, and whether a client's came in force with this step.
  struct Driven {
    Setpoint setpoint;
    bool commanded = false;
  };
  /// As scene->channels.
  std::span<const Driven> channels() const { return channels_; }
  /// Sent in the last Frame::kMessageSteps steps as far as a robot may still hear them, this one's included.
  std::vector<SentMessage> Messages() const;
  /// The newest keyframe at or before it: seed, solver seed; the exact state if the step is its own.
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
  /// Reads on to `step`. `gap` gets whether steps in between were left out.
  bool ReadOn(std::uint64_t step, bool& gap);
  void Replay(std::uint64_t step);
  /// From here on robots are those of `scene`: each keeps its set-points.
  void Enter(const std::shared_ptr<const Scene>& scene);

  RunReader& reader_;
  SavedStatePtr keyframe_;
  std::uint64_t limit_ = 0;             // so far from the keyframe a newer one is looked for
  std::uint64_t newest_ = 0;            // steps after the keyframe are read up to here
  std::vector<Inputs> inputs_;          // of these, those that have any
  std::uint64_t step_ = 0;              // gone to
  std::size_t next_ = 0;                // index of the first inputs after step_
  std::shared_ptr<const Scene> scene_;  // of step_
  std::vector<Driven> channels_;        // of scene_
  std::shared_ptr<const Scene> newest_scene_;
};

class PlayFrames {
 public:
  explicit PlayFrames(RunReader& reader) : reader_(reader), inputs_(reader) {}

  /// The frame of `step`, which has poses. Null, and the reader's error() says why, if the file is damaged.
  std::shared_ptr<Frame> Make(std::uint64_t step);

 private:
  /// The same without samples.
  std::shared_ptr<Frame> MakeMoment(std::uint64_t step);
  /// The newest shown moment at or before `step`, for sensors; null: there is none.
  FramePtr MomentAt(std::uint64_t step);
  /// Fills in what sensors with a rate or a delay show.
  void AddSamples(Frame& frame);
  std::optional<RecordedStep> Read(std::uint64_t step);
  /// What the joint of a control board is told; its way there was not recorded.
  static void ShowAim(const ChannelState& channel, JointControl& control);
  /// Fills in the velocities of the bodies of `frame`; false if the file is damaged.
  bool AddVelocities(const RecordedStep& now, Frame& frame);

  RunReader& reader_;
  PlayInputs inputs_;
  FramePool pool_;
  std::vector<FramePtr> moments_;       // for samples; the newest used last
  std::optional<RecordedStep> newest_;  // made last: mostly the one before
};

/// The angular velocity, rad/s in the world, that turns `from` into `to` within `seconds` the short way.
Vector3 AngularVelocity(const Quaternion& from, const Quaternion& to, double seconds);

}  // namespace coopdyn
