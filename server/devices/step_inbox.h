// SPDX-License-Identifier: MIT
// Brings what happens on the stepping thread to the thread of a robot (or of control): who is to be answered,
// and the frames that subscriptions are made of. In order: the frame of a step before the answers that report
// it; nothing is lost but, when 64 frames wait, the oldest of them, which is counted.
//
// The stepping thread may be the robot's own: a command that makes the last robot ready runs the step inside
// CommandBoard::Command(). So a robot's thread opens a Scope around whatever it does. The answer to the very
// request that the scope is for is there when the board returns (TakeOwn()); what else comes meanwhile, from
// any thread, is handled when the outermost scope closes, without a wake-up. Otherwise one Post() brings the
// whole batch; or, in lockstep, the stepping thread does it itself if this one rests (hand-over).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "server/base/ids.h"
#include "server/state/command_board.h"
#include "server/state/frame_board.h"

namespace coopdyn {

/// Is told about steps, on the thread of the inbox, within a Scope.
class StepListener {
 public:
  virtual ~StepListener() = default;
  /// The wait of `client` has ended.
  virtual void OnStepEnd(ClientId client, const StepResult& result) = 0;
  /// A step has run; `dropped` frames before it were lost. Only while subscribed. False: nobody takes
  /// anything now, so that the next ones wait: the newest of them come after TakesMore().
  virtual bool OnFrame(const FramePtr& frame, int dropped) = 0;
};

/// Its owner's thread only, unless said otherwise. Listeners outlive it, or its owner's thread has stopped.
class StepInbox {
 public:
  /// Frames that wait at most: as many as pushes of one connection, so that no more are lost than there.
  static constexpr std::size_t kMaxFrames = 64;
  /// Runs a function on the owner's thread, later; called from any thread, also when that has ended: a step
  /// that is under way may still bring something to a robot that a load drops. Then it does nothing.
  using Post = std::function<void(std::function<void()>)>;

  /// Any thread. `board` and `frames` outlive it. `hand_over`: as `post`, but runs the function at once on
  /// the calling thread if the owner's rests; null: as `post`.
  StepInbox(CommandBoard& board, const FrameBoard& frames, Post post, const Post& hand_over = nullptr);
  /// Close().
  ~StepInbox();
  StepInbox(const StepInbox&) = delete;
  StepInbox& operator=(const StepInbox&) = delete;

  /// Ends all subscriptions; what still comes is ignored.
  void Close();

  /// While one is open nothing is handled; closing the outermost handles everything. `asking`: whose request
  /// it is for; 0: nobody's.
  class Scope {
   public:
    explicit Scope(StepInbox& inbox, ClientId asking = 0) : inbox_(inbox) { inbox_.Enter(asking); }
    ~Scope() { inbox_.Leave(); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StepInbox& inbox_;
  };

  /// The newest frame. With subscriptions, the pushes up to its step have been made, unless no listener takes
  /// any. Null before the first one.
  FramePtr Current();
  /// A listener that took no frames takes them again: hands out those that have waited for it.
  void TakesMore();
  /// The result for the request that the present Scope is for, if the step has run inside this Scope. With
  /// subscriptions, the pushes up to its step have been made, unless no listener takes any.
  std::optional<StepResult> TakeOwn();
  /// What to hand to the board: it brings the result to `listener` on this thread.
  StepDone Waiter(StepListener& listener, ClientId client);
  /// Runs what it is given on this thread, within a Scope, in order with everything else; never after
  /// Close(). To be called from any thread, also when the inbox is gone.
  using Poster = std::function<void(std::function<void()>)>;
  Poster MakePoster();
  /// The listener gets the frames of the steps from now on. The board is asked for them only while somebody
  /// is subscribed, so that a step wakes this thread only then.
  void Subscribe(StepListener& listener);
  void Unsubscribe(StepListener& listener);

 private:
  struct Item {
    FramePtr frame;  // of a step; null: `result` is for `listener`, or `work` is to be done
    int dropped = 0;
    StepListener* listener = nullptr;
    ClientId client = 0;
    StepResult result;
    std::function<void()> work;  // of a Poster
  };
  class Mailbox;

  void Enter(ClientId asking);
  void Leave();
  /// Moves what has come into queue_; false if nothing has. `leave`: then nothing is expected to be fetched
  /// any more.
  bool Fetch(bool leave);
  void Handle(Item& item);
  /// Hands out all queued frames, leaving the answers.
  void HandleFrames();
  void Deliver(const FramePtr& frame, int dropped);

  CommandBoard& board_;
  const FrameBoard& frames_;
  const std::shared_ptr<Mailbox> mailbox_;  // shared with callbacks that are under way on other threads
  std::vector<StepListener*> listeners_;    // the subscribed ones
  std::uint64_t observer_ = 0;              // key at the board; 0: none
  FramePtr seen_;                           // the last one delivered; only while there is an observer
  bool patient_ = false;                    // no listener takes anything now: frames wait in the mailbox
  std::deque<Item> queue_;
  std::size_t next_ = 0;  // of queue_
  int depth_ = 0;
  ClientId asking_ = 0;            // whom the outermost Scope is for
  std::optional<StepResult> own_;  // of `asking_`
};

}  // namespace coopdyn
