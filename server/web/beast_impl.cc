// SPDX-License-Identifier: MIT
// Beast, compiled once.
#include <utility>

#include <boost/beast/src.hpp>
