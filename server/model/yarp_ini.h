// SPDX-License-Identifier: MIT
// The .ini files that plug-ins of YARP for Gazebo read, and the control boards that several of them make
// together. Pure.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// What such a file says of control boards, in the form of yarp::os::Property.
struct YarpIni {
  struct Device {
    std::string name;  // its section; empty: the file has no section for it
    std::vector<std::string> joints;
  };
  /// Of a network: its first joint on the board, and the first and last one of the device.
  struct Range {
    int board = 0, first = 0, last = 0;
  };

  std::string name;                   // of the board, without the robot's
  std::vector<std::string> networks;  // devices of which the board consists
  std::map<std::string, Range> ranges;
  std::vector<Device> devices;
  bool is_coupled = false;  // it turns the joints of its devices into fewer ones
};
/// What is no such text says nothing. Any bytes.
YarpIni ParseYarpIni(std::string_view text);

struct YarpBoard {
  std::string name;
  std::vector<std::string> joints;
  std::size_t ini = 0;  // which file it is of
};
/// The boards of all files of a robot, in their order. A joint belongs to one board, that with most joints of
/// those that name it; `left_out` has the names of boards that are left without.
std::vector<YarpBoard> YarpBoardsOf(std::span<const YarpIni> inis, std::vector<std::string>& left_out);

}  // namespace coopdyn
