// SPDX-License-Identifier: MIT
#include "clients/cpp/bulk_reader.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "clients/cpp/error.h"
#include "protocol/codec.h"

namespace coopdyn::client {
namespace {

class BulkReaderTest : public testing::Test {
 protected:
  BulkReaderTest() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends_), 0); }
  ~BulkReaderTest() override {
    close(ends_[0]);
    if (ends_[1] >= 0) close(ends_[1]);
  }
  void Write(const std::string& bytes) {
    ASSERT_EQ(write(ends_[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void Close() {
    close(ends_[1]);
    ends_[1] = -1;
  }
  std::optional<Message> Read() { return reader_.Read(ends_[0]); }

  BulkReader reader_;

 private:
  int ends_[2] = {-1, -1};
};

Message Some(std::size_t numbers, const std::string& text = "") {
  Message message{0, text, 110, {1, 2, static_cast<std::int32_t>(numbers)}, {}};
  for (std::size_t i = 0; i < numbers; ++i) message.data.push_back(0.1 * static_cast<double>(i));
  return message;
}

std::string Bytes(const Message& message) {
  std::string bytes;
  EncodeBinary(message, bytes);
  return bytes;
}

TEST_F(BulkReaderTest, ReadsMessagesOfEverySizeAfterEachOther) {
  for (const Message& message : {Some(5), Some(5), Some(0), Some(700), Some(700, "limited 3 robots"),
                                 Some(3, "ß"), Message{4, "refused", 110, {}, {}}, Some(5)}) {
    Write(Bytes(message));
    EXPECT_EQ(Read(), message);
    EXPECT_EQ(Read(), std::nullopt);
  }
}

TEST_F(BulkReaderTest, ReadsMessagesThatCameTogether) {
  const std::vector<Message> messages = {Some(100), Some(2, "abc"), Some(0), Some(100)};
  std::string bytes;
  for (const Message& message : messages) bytes += Bytes(message);
  Write(Bytes(Some(300)));  // the next are taken to be as long
  EXPECT_EQ(Read(), Some(300));
  Write(bytes);
  for (const Message& message : messages) EXPECT_EQ(Read(), message);
  EXPECT_EQ(Read(), std::nullopt);
}

TEST_F(BulkReaderTest, WaitsForTheRestWhereverAMessageIsCut) {
  for (const Message& message : {Some(3, "limited"), Some(4), Some(1, "x")}) {
    const std::string bytes = Bytes(message);
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
      Write(bytes.substr(i, 1));
      EXPECT_EQ(Read(), std::nullopt);
    }
    Write(bytes.substr(bytes.size() - 1));
    EXPECT_EQ(Read(), message);
  }
}

TEST_F(BulkReaderTest, UsesMemoryAgain) {
  Write(Bytes(Some(50)));
  std::vector<double> data = std::move(Read()->data);
  const double* const memory = data.data();
  Write(Bytes(Some(50)));
  Read();
  reader_.Recycle(std::move(data));
  Write(Bytes(Some(50)));
  Read();  // its memory was prepared before
  Write(Bytes(Some(50)));
  const std::optional<Message> message = Read();
  EXPECT_EQ(*message, Some(50));
  EXPECT_EQ(message->data.data(), memory);
}

TEST_F(BulkReaderTest, RefusesWhatIsNoMessage) {
  Write(std::string(24, '\xFF'));
  EXPECT_THROW(Read(), Error);
}

TEST_F(BulkReaderTest, ThePeersEndIsAnError) {
  Write(Bytes(Some(2)).substr(0, 30));
  EXPECT_EQ(Read(), std::nullopt);
  Close();
  EXPECT_THROW(Read(), Closed);
}

}  // namespace
}  // namespace coopdyn::client
