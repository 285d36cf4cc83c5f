// SPDX-License-Identifier: MIT
#include <cstdlib>
#include <cstring>

#include "server/controllers/child_process.h"

int main(int argc, char** argv) {
  if (argc != 3 || std::strcmp(argv[1], "controller-child") != 0) return 2;
  return coopdyn::RunControllerChild(std::atoi(argv[2]));
}
