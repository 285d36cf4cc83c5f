// SPDX-License-Identifier: MIT
// The streams of our ports: readings stamped with simulated time. No sockets.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "protocol/message.h"
#include "server/net/encoding.h"
#include "server/yarp/board_stream.h"
#include "server/yarp/bottle.h"
#include "server/yarp/carrier.h"
#include "server/yarp/port_name.h"

namespace coopdyn {

/// Writes the readings of one connection.
class YarpSampleWriter {
 public:
  /// Appends a reading, which ends with time_s and step, as data without reply. Without text and params it is
  /// a Vector. The sequence number also counts dropped readings.
  void Append(const Message& reading, YarpCarrier carrier, YarpDialect dialect, std::string& out);
  void set_sample(YarpSample sample) { sample_ = sample; }
  /// For a lidar: the reply to get_scan_geometry.
  void set_geometry(Message geometry) { geometry_ = std::move(geometry); }

 private:
  YarpSample sample_ = YarpSample::kReading;
  BoardSampler board_;  // for YarpSample::kBoard
  Message geometry_;    // for YarpSample::kLaserScan
  std::int32_t sequence_ = 0;
};

/// A connection opened by us to send a module's reading.
class YarpOutput final : public Encoding {
 public:
  /// Called on the session's thread; may be null.
  struct Events {
    std::function<void()> end = {};  // the output is destroyed
    // the reader acknowledged the sample of `step`
    std::function<void(std::uint64_t step)> taken = {};
    std::function<void(const std::string& why)> fails = {};  // no more samples will come
  };
  /// The first bytes to decode are the reader's welcome.
  YarpOutput(YarpCarrier carrier, YarpDialect dialect, YarpStream stream, Events events);
  ~YarpOutput() override;
  YarpOutput(const YarpOutput&) = delete;
  YarpOutput& operator=(const YarpOutput&) = delete;

  Incoming Decode(std::string_view bytes) override;
  std::optional<Message> Next(const Message& reply, std::string& out) override;
  void Reply(const Message& reply, std::string& out) override;
  void Push(UnaskedMessage& push, std::string& out) override;
  bool takes_push() const override { return unacknowledged_ == 0; }

 private:
  void Append(const Message& reading, std::string& out);
  /// Pictures are requested after each step instead of pushed.
  bool pulls() const { return stream_.sample == YarpSample::kImage || stream_.sample == YarpSample::kDepth; }
  Message FirstRequest() const;
  Message Picture() const;
  Message NextStep() const;
  std::optional<Message> AfterPicture(const Message& picture, std::string& out);
  Incoming Acknowledged(std::string_view bytes);

  const YarpCarrier carrier_;
  const YarpDialect dialect_;
  const YarpStream stream_;
  const Events events_;
  enum class State { kWelcome, kFirstReading, kStreams } state_ = State::kWelcome;
  int unacknowledged_ = 0;
  std::uint64_t sent_step_ = 0;  // of the last sample
  int errors_ = 0;               // of pictures, in a row
  double pulled_s_ = -1;         // time of the last picture sent
  YarpSampleWriter writer_;
};

}  // namespace coopdyn
