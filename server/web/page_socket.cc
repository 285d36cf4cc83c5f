// SPDX-License-Identifier: MIT
#include "server/web/page_socket.h"

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/option.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/json.hpp>
#include <cmath>

#include "protocol/json_text.h"
#include "server/web/access.h"
#include "server/web/http_routes.h"

namespace coopdyn {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

namespace {

constexpr std::size_t kLeastCompressed = 1000;  // bytes
// 2 MB a second: crowds' sensors come less often, which leaves time for the rest.
constexpr std::chrono::nanoseconds kTimePerSensorByte{500};

boost::json::array PointOf(const Vector3& point) {
  return {point.x(), point.y(), point.z()};
}

/// A binary message with a picture; see page_socket.h.
std::string PictureMessage(const ImageResult& result) {
  const std::string json =
      JsonText(result.error.empty() ? boost::json::object{{"time_s", ToSeconds(result.time)},
                                                          {"step", result.step},
                                                          {"eye", PointOf(result.camera.eye_m)},
                                                          {"look", PointOf(result.camera.look_m)}}
                                    : boost::json::object{{"error", result.error}});
  std::string message(1, '\1');
  for (int shift = 0; shift < 32; shift += 8) message += static_cast<char>((json.size() >> shift) & 0xffU);
  message += json;
  if (result.bytes) message.append(result.bytes->begin(), result.bytes->end());
  return message;
}

PeerInfo PageOf(PeerInfo peer) {
  peer.text = "page " + peer.text;
  return peer;
}

}  // namespace

PageSocket::PageSocket(beast::tcp_stream stream, WebContext& context, PeerInfo peer)
    : socket_(std::move(stream)),
      context_(context),
      bridge_(context.io, context.names, context.frames, PageOf(std::move(peer)),
              [this](const PageReply& reply) { OnReply(reply); }),
      view_(context.io, context.pictures, [this](const ImageResult& result) { OnPicture(result); }),
      pose_cadence_(context.io, [this] { WriteNext(); }),
      sensor_cadence_(context.io, [this] { WriteNext(); }) {}

void PageSocket::Start(http::request<http::string_body> upgrade) {
  upgrade_ = std::move(upgrade);
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own timeouts
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = kHandshakeTime;
  timeout.idle_timeout = kSilence;
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  // The status lists all robots and their modules; compression reduces it to a tenth.
  websocket::permessage_deflate compression;
  compression.server_enable = true;
  compression.compLevel = 3;
  compression.memLevel = 5;
  compression.msg_size_threshold = kLeastCompressed;
  socket_.set_option(compression);
  socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    for (const auto& [name, value] : CommonHeaders()) response.set(name, value);
  }));
  socket_.read_message_max(bridge_.trusted() ? kMaxMessageBytes : kMaxStrangersMessageBytes);
  socket_.async_accept(upgrade_, [self = shared_from_this()](error_code failed) {
    if (failed) return self->Close();
    self->open_ = true;
    const bool only_poses = self->upgrade_.target().ends_with(kOnlyPoses);
    if (!only_poses) {
      self->context_.status.Watch(self);
      self->person_ = self->context_.people.Enter(self);
    }
    self->OnHello({});
    if (!only_poses) self->context_.people.Set(self->person_, {});
    self->Read();
  });
}

void PageSocket::Close() {
  if (open_) context_.people.Leave(person_);
  open_ = false;
  view_.Set(std::nullopt);
  pose_cadence_.Set(0);
  sensor_cadence_.Set(0);
  beast::get_lowest_layer(socket_).close();
}

void PageSocket::Read() {
  if (reading_ || !open_ || overfull()) return;
  reading_ = true;
  socket_.async_read(buffer_, [self = shared_from_this()](error_code failed, std::size_t) {
    self->reading_ = false;
    if (failed) return self->Close();
    const auto bytes = self->buffer_.cdata();
    self->OnMessage({static_cast<const char*>(bytes.data()), bytes.size()});
    self->buffer_.consume(self->buffer_.size());
    self->Read();
  });
}

void PageSocket::OnMessage(std::string_view text) {
  PageRead read = ReadPageMessage(text);
  if (!read.message) {
    PageReply reply;
    reply.id = read.id;
    reply.message = ErrorReply(-2, Error::kMalformed, read.error);
    return Send(WritePageReply(reply));
  }
  if (const auto* call = std::get_if<PageCall>(&*read.message)) {
    TakeToken(call->token);
    bridge_.Handle(*call);
  } else if (const auto* hello = std::get_if<PageHello>(&*read.message)) {
    OnHello(*hello);
  } else if (const auto* view = std::get_if<PageView>(&*read.message)) {
    view_.Set(view->request);
  } else if (std::holds_alternative<PageShown>(*read.message)) {
    view_.Shown();
  } else if (const auto* poses = std::get_if<PagePoses>(&*read.message)) {
    poses_.Restart();
    pose_cadence_.Set(poses->rate_hz);
  } else if (const auto* sensors = std::get_if<PageSensors>(&*read.message)) {
    sensors_ = nullptr;
    sensor_cadence_.Set(sensors->rate_hz);
  } else if (const auto* close = std::get_if<PageClose>(&*read.message)) {
    bridge_.CloseLink(close->module, close->channel);
  } else if (const auto* me = std::get_if<PageMe>(&*read.message)) {
    bridge_.SetPerson(me->name);
    context_.people.Set(person_, *me);
  }
}

void PageSocket::TakeToken(const std::string& token) {
  if (bridge_.trusted() || !context_.TakesToken(token, bridge_.peer())) return;
  bridge_.SetTrusted(true);
  socket_.read_message_max(kMaxMessageBytes);
}

void PageSocket::OnHello(const PageHello& hello) {
  TakeToken(hello.token);
  const bool wrong = !hello.token.empty() && !bridge_.trusted();
  const std::string wait = wrong ? context_.TokenWaitText(bridge_.peer()) : std::string();
  boost::json::object said{
      {"type", "hello"}, {"version", context_.options.version}, {"trusted", bridge_.trusted()}};
  if (context_.services.read_only()) said["read_only"] = true;
  if (wrong) said["wrong_token"] = true;
  if (!wait.empty()) said["token_wait"] = wait;
  said["person"] = person_;
  said["pictures"] = context_.pictures.available();
  Send(JsonText(said));
}

void PageSocket::OnStatus(const std::shared_ptr<const std::string>& status) {
  if (!open_) return;
  status_ = status;
  WriteNext();
}

void PageSocket::OnPeople(const std::shared_ptr<const std::string>& people) {
  if (!open_) return;
  people_ = people;
  WriteNext();
}

void PageSocket::OnReply(PageReply reply) {
  const bool push = !reply.id;
  if (push && dropped_pushes_ > 0) {
    reply.message.text = "dropped " + std::to_string(dropped_pushes_);
    dropped_pushes_ = 0;
  }
  Send(WritePageReply(reply), push);
}

void PageSocket::OnPicture(const ImageResult& result) {
  picture_ = PictureMessage(result);
  WriteNext();
}

std::string PageSocket::TakePoses() {
  const FramePtr frame = pose_cadence_.Take(context_.frames);
  return frame == nullptr ? "" : poses_.Next(*frame, context_.scenes.Of(frame->scene));
}

SensorFeed::Message PageSocket::TakeSensors() {
  const FramePtr frame = sensor_cadence_.Take(context_.frames);
  if (frame == nullptr) return nullptr;
  const auto [message, wait] = context_.sensors.Take(frame, context_.services.clock());
  const std::chrono::nanoseconds pause = message->size() * kTimePerSensorByte;
  if (wait > 0)
    sensor_cadence_.Postpone(std::max(pause, std::chrono::nanoseconds(wait)));
  else
    sensor_cadence_.Pause(pause);
  if (sensors_ != nullptr && *message == *sensors_) return nullptr;
  return sensors_ = message;
}

void PageSocket::Send(std::string text, bool push) {
  if (!open_) return;
  queued_bytes_ += text.size();
  queued_pushes_ += push ? 1 : 0;
  queue_.push_back({std::move(text), push});
  if (queued_pushes_ > kMaxQueuedPushes) {
    const auto oldest =
        std::find_if(queue_.begin(), queue_.end(), [](const Outgoing& entry) { return entry.push; });
    queued_bytes_ -= oldest->text.size();
    queue_.erase(oldest);
    --queued_pushes_;
    ++dropped_pushes_;
  }
  WriteNext();
}

void PageSocket::WriteNext() {
  if (writing_ || !open_) return;
  if (!queue_.empty()) {
    Outgoing& next = queue_.front();
    queued_bytes_ -= next.text.size();
    queued_pushes_ -= next.push ? 1 : 0;
    written_ = std::move(next.text);
    queue_.pop_front();
    Write(written_, false);
  } else if (status_) {
    written_ = R"({"type":"status","status":)" + *status_ + "}";
    status_ = nullptr;
    Write(written_, false);
  } else if (people_) {
    written_ = *people_;
    people_ = nullptr;
    Write(written_, false);
  } else if (std::string poses = TakePoses(); !poses.empty()) {
    written_ = std::move(poses);
    Write(written_, true);
  } else if (const SensorFeed::Message sensors = TakeSensors(); sensors != nullptr) {
    Write(*sensors, true, sensors);
  } else if (!picture_.empty()) {
    written_.swap(picture_);
    picture_.clear();
    Write(written_, true);
  }
}

void PageSocket::Write(std::string_view bytes, bool binary, SensorFeed::Message keep) {
  writing_ = true;
  socket_.binary(binary);
  socket_.compress(!binary);  // poses and pictures are compact already
  socket_.async_write(boost::asio::buffer(bytes),
                      [self = shared_from_this(), keep = std::move(keep)](error_code failed, std::size_t) {
                        self->writing_ = false;
                        if (failed) return self->Close();
                        self->WriteNext();
                        self->Read();  // may have paused at a full queue
                      });
}

}  // namespace coopdyn
