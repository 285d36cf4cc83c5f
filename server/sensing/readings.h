// SPDX-License-Identifier: MIT
// The sensors as functions of (frame, robot, seed). Computed when first asked for, once per frame and sensor,
// and kept with the frame; nobody asks, no cost. Any thread.
#pragma once

#include <span>
#include <vector>

#include "server/base/worker_pool.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Distance and bearing of a landmark as a robot sees it.
struct Sighting {
  int index = 0;           // into scene->targets or scene->robots
  double distance_m = 0;   // from the robot's axle middle, in the plane
  double bearing_rad = 0;  // 0 ahead, left positive
};

/// One range per distance sensor (right to left), m from the chassis surface, inf = nothing in range.
/// Valid as long as the frame lives.
std::span<const double> Distances(const Frame& frame, int robot);
/// Targets seen by `robot`, by increasing id.
std::vector<Sighting> SeenTargets(const Frame& frame, int robot);
/// Other robots seen by `robot`, by increasing id.
std::vector<Sighting> SeenRobots(const Frame& frame, int robot);

/// Others within the range of `robot`'s neighbours module, by increasing id. Seen through obstacles.
/// Empty if its model has no such module.
std::vector<Sighting> Neighbours(const Frame& frame, int robot);
/// The same, appended to `seen`.
void AppendNeighbours(const Frame& frame, int robot, std::vector<Sighting>& seen);

/// A broadcast that `robot` hears in this frame.
struct HeardMessage {
  int sender = 0;                         // index into scene->robots
  Sighting from;                          // where the sender is now; index = sender
  const RobotMessage* message = nullptr;  // lives as long as the frame
};
/// What `robot` hears in this frame, by increasing id of the sender: messages that were sent
/// model.neighbours.delay_steps steps before this one, from within the message range as the robots stand in
/// this frame, and not lost; delay, range and loss are those of the receiver's model. Loss is a function of
/// (seed, sender, receiver, step).
std::vector<HeardMessage> HeardMessages(const Frame& frame, int robot);
/// The same, appended to `heard`.
void AppendHeard(const Frame& frame, int robot, std::vector<HeardMessage>& heard);

/// Computes the distances of `robots` (indices into the scene) now, in parallel; Distances() then costs
/// nothing. The values do not depend on the number of threads.
void PrepareDistances(const Frame& frame, std::span<const int> robots, WorkerPool& pool);

/// For drawing: where each ray of robot's distance sensors starts and ends in the world.
struct RaySegment {
  Vector3 from_W, to_W;
  bool hit = false;
};
std::vector<RaySegment> DistanceRays(const Frame& frame, int robot);

}  // namespace coopdyn
