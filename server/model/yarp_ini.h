// SPDX-License-Identifier: MIT
// Parses the .ini files of YARP's Gazebo plugins and combines them into control boards. Pure.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// The control boards in such a file, which has the form of yarp::os::Property.
struct YarpIni {
  struct Device {
    std::string name;  // its section; empty if outside any section
    std::vector<std::string> joints;
  };
  /// The joints of a network: its first joint on the board, and the first and last joint of the device.
  struct Range {
    int board = 0, first = 0, last = 0;
  };

  std::string name;                   // of the board, without the robot's name
  std::vector<std::string> networks;  // the board's devices
  std::map<std::string, Range> ranges;
  std::vector<Device> devices;
  bool is_coupled = false;  // couples the joints of its devices into fewer ones
};
/// Accepts any bytes; ignores lines of other forms.
YarpIni ParseYarpIni(std::string_view text);

struct YarpBoard {
  std::string name;
  std::vector<std::string> joints;
  std::size_t ini = 0;  // index of its file
};
/// The boards of all files of a robot, in file order. A joint that several boards name belongs to the one
/// with the most joints. Sets `left_out` to the names of boards without joints.
std::vector<YarpBoard> YarpBoardsOf(std::span<const YarpIni> inis, std::vector<std::string>& left_out);

}  // namespace coopdyn
