// SPDX-License-Identifier: MIT
// The one place where Asio's own sources are compiled (BOOST_ASIO_SEPARATE_COMPILATION).
#include <utility>

#include <boost/asio/impl/src.hpp>
