// SPDX-License-Identifier: MIT
#include "server/naming/name_protocol.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "protocol/text_scan.h"
#include "server/base/printable.h"
#include "server/net/encoding.h"
#include "server/net/net_services.h"

namespace coopdyn {
namespace {

constexpr std::string_view kPrefix = "NAME_SERVER";
constexpr std::string_view kEnd = "*** end of message\r\n";
constexpr std::string_view kAutomatic = "...";

using Words = std::vector<std::string>;

/// Splits at spaces; "quoted words" lose their quotes.
Words Split(std::string_view line) {
  Words words;
  std::size_t i = 0;
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (true) {
    while (i < line.size() && is_space(line[i])) ++i;
    if (i == line.size()) return words;
    std::string word;
    if (line[i] == '"') {
      for (++i; i < line.size() && line[i] != '"'; ++i) word += line[i];
      if (i < line.size()) ++i;
    } else {
      while (i < line.size() && !is_space(line[i])) word += line[i++];
    }
    words.push_back(std::move(word));
  }
}

/// The n-th word; empty if it is missing or "..." (to be filled in by us).
std::string WordAt(const Words& words, std::size_t n) {
  return n < words.size() && words[n] != kAutomatic ? words[n] : std::string();
}

std::string Join(const Words& words, std::size_t first) {
  std::string text;
  for (std::size_t i = first; i < words.size(); ++i) text += (i == first ? "" : " ") + words[i];
  return text;
}

/// A peer's text, uncut, safe for a terminal.
std::string Whole(const std::string& text) {
  return Printable(text, text.size());
}

bool IsHttp(std::string_view line) {
  if (line.starts_with("GET /")) return true;  // YARP's mjpeg ends the line before HTTP/
  const std::size_t space = line.find(' ');
  const std::string_view method = line.substr(0, space);
  return space != std::string_view::npos && space > 0 &&
         line.find("HTTP/", space) != std::string_view::npos &&
         std::all_of(method.begin(), method.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// A name that can be opened, for messages.
std::string ExampleName(const NameTable& table) {
  for (const NameEntry& entry : table.List()) {
    if (entry.adopt && entry.name.find('/', 1) != std::string::npos) return entry.name;  // a robot's
  }
  return "/robot1/motors";
}

/// Answers one request in its context: one member per verb.
class Answerer {
 public:
  Answerer(Words words, const NameContext& context, NameTable& table)
      : words_(std::move(words)), context_(context), asker_{context.peer_ip, context.now}, table_(table) {}

  NameReply Answer(bool prefixed) {
    const std::string& verb = words_[0];
    if (verb == "query") return Query();
    if (verb == "list") return List();
    const bool changes = verb == "register" || verb == "unregister" || verb == "set";
    if (changes && context_.read_only) return Refused(kReadOnlyText);
    if (verb == "register") return Register();
    if (verb == "unregister") return Unregister();
    if (verb == "set") return Set();
    if (verb == "get") return Get();
    if (verb == "check") return Check();
    if (verb == "route") return Route();
    if (verb == "announce") return Announce();
    if (verb == "subscribe" || verb == "unsubscribe") return Subscribe(verb == "subscribe");
    if (verb == "bot") return Bot();
    if (verb == "help") return Help();
    if (!Farewell(verb).empty()) return Leave();
    if (prefixed) return End();
    return Refused("\"" + verb.substr(0, 64) + "\" is not a request: help lists all");
  }

  NameReply Open() {
    const std::string name = WordAt(words_, 1);
    if (name.empty())
      return {"error 10 OPEN takes a name, as in OPEN " + ExampleName(table_) + "; list shows all\n"};
    if (words_.size() > 2) return {"error 4 OPEN takes one name, not " + Printable(words_[2]) + " as well\n"};
    const std::optional<NameEntry> entry = Find(name);
    if (!entry) {
      const std::string nearest = table_.Nearest(name);
      return {"error 10 no such name " + Printable(name) +
              (nearest.empty() ? "; list shows all" : "; did you mean " + nearest + "?") + "\n"};
    }
    if (!entry->adopt) {
      return {"error 10 " + entry->name + " is another program's: connect to " + entry->ip + " port " +
              std::to_string(entry->port) + "\n"};
    }
    NameReply reply{"ok\n"};
    reply.open = entry->adopt;
    reply.opened = entry->name;
    return reply;
  }

 private:
  static NameReply End(std::string text = {}) { return {std::move(text) + std::string(kEnd)}; }
  static NameReply Leave() {
    NameReply reply = End();
    reply.close = true;
    return reply;
  }
  static NameReply Refused(const std::string& why) { return End("*** refused: " + why + "\r\n"); }

  std::optional<NameEntry> Find(const std::string& name) const {
    std::optional<NameEntry> entry = table_.Find(name);
    // Our own port goes before another program's of the same name.
    if (context_.hooks != nullptr && (!entry || entry->external)) {
      context_.hooks->open(name.starts_with('/') ? name : "/" + name, asker_.ip);
      entry = table_.Find(name);
    }
    if (entry) table_.Touch(entry->name, asker_.now);
    return entry;
  }

  const std::string& IpOf(const NameEntry& entry) const {
    if (!entry.ip.empty()) return entry.ip;
    return context_.advertise.empty() ? context_.asked_at : context_.advertise;
  }

  std::string Registration(const NameEntry& entry) const {
    return "registration name " + entry.name + " ip " + IpOf(entry) + " port " + std::to_string(entry.port) +
           " type " + entry.type + "\r\n";
  }

  std::string BotPort(const NameEntry& entry) const {
    return "port (name \"" + entry.name + "\") (ip \"" + IpOf(entry) + "\") (port_number " +
           std::to_string(entry.port) + ") (carrier " + entry.type + ")";
  }

  NameReply Query() const {
    const std::optional<NameEntry> entry = Find(WordAt(words_, 1));
    return End(entry ? Registration(*entry) : "");
  }

  NameReply Announce() const {
    const std::string name = WordAt(words_, 1);
    table_.Touch(name, asker_.now);
    if (context_.hooks == nullptr || name.empty()) return {"[ok]\r\n"};
    for (const Subscription& each : table_.Subscriptions(name)) {
      Find(each.from);  // the port may have been closed since
      context_.hooks->connect(each, true);
    }
    return {"[ok]\r\n"};
  }

  NameReply Subscribe(bool adds) {
    if (words_.size() < 2) {
      std::string text = "subscriptions";
      for (const Subscription& each : table_.Subscriptions())
        text += " (subscription (src \"" + each.from + "\") (dest \"" + each.to + "\"))";
      return End(text + "\r\n");
    }
    const Subscription subscription{NameInAddress(WordAt(words_, 1)), NameInAddress(WordAt(words_, 2))};
    if (!NameProblem(subscription.from).empty() || !NameProblem(subscription.to).empty())
      return Refused("write two ports, as in subscribe /clock /me/clock:i");
    if (!adds) table_.Unsubscribe(subscription);
    if (adds && !table_.Subscribe(subscription)) return Refused("there are too many subscriptions");
    Find(subscription.from);
    if (context_.hooks != nullptr) context_.hooks->connect(subscription, adds);
    return {"[ok]\r\n"};
  }

  NameReply List() const {
    std::string text;
    for (const NameEntry& entry : table_.List(WordAt(words_, 1))) text += Registration(entry);
    return End(std::move(text));
  }

  NameReply Register() {
    int port = 0;
    const std::string digits = WordAt(words_, 4);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (!digits.empty() && (error != std::errc() || end != digits.data() + digits.size())) port = -1;
    if (digits == "-1") port = 0;  // sent by ports that give the type of their data, the next word
    Find(WordAt(words_, 1));       // reserves the name of one of our ports that is not open yet
    NameTable::Change change =
        table_.Register(WordAt(words_, 1), WordAt(words_, 2), WordAt(words_, 3), port, asker_);
    return change.refused.empty() ? End(Registration(change.entry)) : Refused(change.refused);
  }

  NameReply Unregister() {
    const NameTable::Change change = table_.Unregister(WordAt(words_, 1), asker_);
    return change.refused.empty() ? End() : Refused(change.refused);
  }

  NameReply Set() {
    const std::string key = WordAt(words_, 2);
    const NameTable::Change change = table_.SetProperty(WordAt(words_, 1), key, Join(words_, 3), asker_);
    if (!change.refused.empty()) return Refused(change.refused);
    return change.entry.name.empty() ? End() : Property(change.entry, key);
  }

  NameReply Get() const {
    const std::optional<NameEntry> entry = table_.Find(WordAt(words_, 1));
    return entry ? Property(*entry, WordAt(words_, 2)) : End();
  }

  static NameReply Property(const NameEntry& entry, const std::string& key) {
    const auto it = entry.properties.find(key);
    return End("port " + entry.name + " property " + Whole(key) + " = " +
               (it == entry.properties.end() ? "" : Whole(it->second)) + "\r\n");
  }

  NameReply Check() const {
    const std::optional<NameEntry> entry = table_.Find(WordAt(words_, 1));
    if (!entry) return End();
    const std::string key = WordAt(words_, 2);
    const std::string value = WordAt(words_, 3);
    const auto it = entry->properties.find(key);
    const Words values = it == entry->properties.end() ? Words() : Split(it->second);
    const bool present = std::find(values.begin(), values.end(), value) != values.end();
    return End("port " + entry->name + " property " + Whole(key) + " value " + Whole(value) + " present " +
               (present ? "true" : "false") + "\r\n");
  }

  NameReply Route() const {
    const std::optional<NameEntry> from = table_.Find(WordAt(words_, 1));
    const std::optional<NameEntry> to = table_.Find(WordAt(words_, 2));
    if (!from || !to) return End();
    return End("port " + from->name + " route " + to->name + " = " + to->type + ":/" + to->name + "\r\n");
  }

  NameReply Bot() const {
    const std::string what = WordAt(words_, 1);
    if (what == "query") {
      const std::optional<NameEntry> entry = Find(WordAt(words_, 2));
      return {(entry ? BotPort(*entry) : "port (error -2 \"port not known\")") + "\r\n"};
    }
    if (what != "list") return End();
    std::string text = "ports";
    for (const NameEntry& entry : table_.List(WordAt(words_, 2))) text += " (" + BotPort(entry) + ")";
    return {text + "\r\n"};
  }

  static NameReply Help() {
    return End(
        "Here are some ways to use the name server (with or without NAME_SERVER before them):\r\n"
        "+ help\r\n"
        "+ list [$prefix]\r\n"
        "+ query $name\r\n"
        "+ register $name\r\n"
        "+ register $name $carrier $ipAddress $portNumber\r\n"
        "  (if you want a field set automatically, write '...')\r\n"
        "+ unregister $name\r\n"
        "+ set $name $property $value\r\n"
        "+ get $name $property\r\n"
        "+ check $name $property $value\r\n"
        "+ subscribe $source $destination\r\n"
        "+ OPEN $name\r\n"
        "  (turns this connection into one of that module's: then write help again)\r\n"
        "+ exit\r\n");
  }

  const Words words_;
  const NameContext& context_;
  const NameAsker asker_;
  NameTable& table_;
};

}  // namespace

NameReply AnswerNameLine(std::string_view line, const NameContext& context, NameTable& table) {
  if (IsHttp(line)) {
    NameReply refusal{HttpRefusal()};
    refusal.close = true;
    return refusal;
  }
  Words words = Split(line);
  if (words.empty()) return {};
  table.Forget(context.now);
  const bool prefixed = words[0] == kPrefix;
  if (prefixed) words.erase(words.begin());
  if (words.empty()) return {std::string(kEnd)};
  const bool open = words[0] == "OPEN" || words[0] == "open";
  Answerer answerer(std::move(words), context, table);
  return open ? answerer.Open() : answerer.Answer(prefixed);
}

std::string NameInAddress(std::string_view address) {
  const std::size_t carrier = address.find(":/");
  return std::string(carrier == std::string_view::npos ? address : address.substr(carrier + 2));
}

NameReply AnswerMagic(const NameTable& table) {
  NameReply reply{"error 7 this is the port of names: send OPEN " + ExampleName(table) +
                  " and a newline, wait for ok, and then CDS1 and frames\n"};
  reply.close = true;
  return reply;
}

}  // namespace coopdyn
