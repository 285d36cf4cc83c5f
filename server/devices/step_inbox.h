// SPDX-License-Identifier: MIT
// Brings results of the stepping thread to the thread of a robot (or of control): ends of waits, and frames
// for subscriptions. Items arrive in order: a step's frame before the answers that report it. Nothing is
// lost, except that with 64 waiting frames the oldest is dropped and counted.
//
// The stepping thread may be the robot's own: a command that makes the last robot ready runs the step inside
// CommandBoard::Command(). So a robot's thread opens a Scope around all its work. The result of the scope's
// own request is available when the board returns (TakeOwn()). Items that arrive meanwhile, from any thread,
// are handled when the outermost scope closes, without a wake-up. Otherwise one Post() brings the whole
// batch; or, in lockstep, the stepping thread handles it itself if this thread sleeps (hand-over).
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

/// Receives step events on the inbox's thread, within a Scope.
class StepListener {
 public:
  virtual ~StepListener() = default;
  /// The wait of `client` has ended.
  virtual void OnStepEnd(ClientId client, const StepResult& result) = 0;
  /// A step has run; `dropped` frames before it were lost. Called only while subscribed. Returns false if no
  /// client accepts pushes now: later frames wait, and the newest of them are delivered after TakesMore().
  virtual bool OnFrame(const FramePtr& frame, int dropped) = 0;
};

/// Used only on its owner's thread, unless stated otherwise. Listeners outlive it, or its owner's thread has
/// stopped.
class StepInbox {
 public:
  /// Limit of waiting frames: as large as that of a connection's pushes, so no more are lost here than there.
  static constexpr std::size_t kMaxFrames = 64;
  /// Runs a function on the owner's thread, later. Called from any thread, and does nothing once that thread
  /// has ended: a running step may still have a result for a robot that a load drops.
  using Post = std::function<void(std::function<void()>)>;

  /// Any thread. `board` and `frames` outlive it. `hand_over`: like `post`, but if the owner's thread sleeps,
  /// runs the function at once on the calling thread; null: `post`.
  StepInbox(CommandBoard& board, const FrameBoard& frames, Post post, const Post& hand_over = nullptr);
  /// Calls Close().
  ~StepInbox();
  StepInbox(const StepInbox&) = delete;
  StepInbox& operator=(const StepInbox&) = delete;

  /// Ends all subscriptions; ignores later items.
  void Close();

  /// While a scope is open, nothing is handled; closing the outermost scope handles everything. `asking`: the
  /// client whose request the scope is for; 0: none.
  class Scope {
   public:
    explicit Scope(StepInbox& inbox, ClientId asking = 0) : inbox_(inbox) { inbox_.Enter(asking); }
    ~Scope() { inbox_.Leave(); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StepInbox& inbox_;
  };

  /// The newest frame; null before the first one. With subscriptions, the pushes up to its step have been
  /// made, unless no listener accepts any.
  FramePtr Current();
  /// A listener that refused frames accepts them again: delivers the waiting ones.
  void TakesMore();
  /// The result of the current Scope's request, if the step ran inside this Scope. With subscriptions, the
  /// pushes up to its step have been made, unless no listener accepts any.
  std::optional<StepResult> TakeOwn();
  /// The callback for the board: brings the result to `listener` on this thread.
  StepDone Waiter(StepListener& listener, ClientId client);
  /// Runs its argument on this thread, within a Scope, in order with all other items; never after Close().
  /// May be called from any thread, even after the inbox is destroyed.
  using Poster = std::function<void(std::function<void()>)>;
  Poster MakePoster();
  /// The listener receives the frames of later steps. Without subscribers, steps don't wake this thread.
  void Subscribe(StepListener& listener);
  void Unsubscribe(StepListener& listener);

 private:
  struct Item {
    FramePtr frame;  // of a step; null: `result` for `listener`, or `work`
    int dropped = 0;
    StepListener* listener = nullptr;
    ClientId client = 0;
    StepResult result;
    std::function<void()> work;  // of a Poster
  };
  class Mailbox;

  void Enter(ClientId asking);
  void Leave();
  /// Moves arrived items into queue_; returns false if there are none. `leave`: then leaves the busy state.
  bool Fetch(bool leave);
  void Handle(Item& item);
  /// Delivers all queued frames, but not the results.
  void HandleFrames();
  void Deliver(const FramePtr& frame, int dropped);

  CommandBoard& board_;
  const FrameBoard& frames_;
  const std::shared_ptr<Mailbox> mailbox_;  // shared with callbacks running on other threads
  std::vector<StepListener*> listeners_;    // the subscribed ones
  std::uint64_t observer_ = 0;              // key at the board; 0: none
  FramePtr seen_;                           // last delivered frame; null without observer
  bool patient_ = false;                    // no listener accepts frames now: they wait in the mailbox
  std::deque<Item> queue_;
  std::size_t next_ = 0;  // index into queue_
  int depth_ = 0;
  ClientId asking_ = 0;            // the client that the outermost Scope is for
  std::optional<StepResult> own_;  // result for asking_
};

}  // namespace coopdyn
