// SPDX-License-Identifier: MIT
// Answers requests to a YARP device from its module's readings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "protocol/command_ids.h"
#include "server/yarp/struct_writer.h"
#include "server/yarp/translator.h"

namespace coopdyn {

/// The codes of yarp::dev::ReturnValue that we use.
enum class ReturnCode { kDone = 0, kNotThere = 2 };

/// Asks the module for a reading, may send it a command, then answers.
class ReadingTranslator : public YarpTranslator {
 public:
  void set_dialect(YarpDialect dialect) final { dialect_ = dialect; }

  Decoded Decode(const Bottle& request) final;
  std::optional<Message> Next(const Message& reply) final {
    return std::exchange(asked_, false) && reply.error == 0 ? Command(reply) : std::nullopt;
  }

  YarpAnswer Reply(const Message& reply) final;

 protected:
  /// The command that reads the module.
  virtual command::Id Reading() const { return command::kPing; }
  /// The module's command that follows, if any.
  virtual std::optional<Message> Command(const Message& /*reading*/) { return std::nullopt; }
  /// The supported requests.
  virtual std::string_view Help() const = 0;
  /// Answers from the reply to the reading or command. Nullopt if there is no such request.
  virtual std::optional<YarpAnswer> Answer(const Message& reply) = 0;

  const Bottle& request() const { return request_; }
  const std::string& name() const { return name_; }
  std::size_t arguments() const { return at_; }

  static YarpAnswer Fail(const std::string& why) { return {BottleOf(YarpVocab{"fail"}, why), {}}; }
  /// An answer of these bytes; as text, the same decoded as a Bottle.
  static YarpAnswer OfBytes(std::string bytes, const Bottle& if_none = {}) {
    YarpDialect dialect = YarpDialect::k3;
    Bottle shown = DecodeBottle(bytes, dialect).value_or(if_none);
    return {std::move(shown), std::move(bytes)};
  }
  /// A code, then `fields` fields written by `fill`.
  template <typename Fill>
  YarpAnswer Returned(ReturnCode code, std::size_t fields, const Fill& fill) const {
    std::string bytes;
    YarpStructWriter write(dialect_, bytes);
    if (fields > 0) write.Struct(1 + fields);
    AppendCode(code, write);
    fill(write);
    return OfBytes(std::move(bytes), BottleOf(static_cast<std::int32_t>(code)));
  }
  YarpAnswer Returned(ReturnCode code) const {
    return Returned(code, 0, [](YarpStructWriter&) {});
  }

 private:
  void AppendCode(ReturnCode code, YarpStructWriter& write) const {
    if (dialect_ == YarpDialect::k3) return write.Int(static_cast<std::int32_t>(code));
    write.Struct(1);
    write.Vocab(code == ReturnCode::kDone ? "ok" : "err2");
  }

  Bottle request_;
  std::string name_;
  std::size_t at_ = 1;
  bool asked_ = false;  // a request to the module is pending
  YarpDialect dialect_ = YarpDialect::k3;
};

}  // namespace coopdyn
