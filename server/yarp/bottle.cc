// SPDX-License-Identifier: MIT
#include "server/yarp/bottle.h"

#include <algorithm>
#include <cstring>

#include "server/yarp/yarp_bytes.h"

namespace coopdyn {
namespace {

enum Tag : std::int32_t {
  kInt32 = 1,
  kString = 4,
  kVocab32 = 9,
  kTen = 10,  // float64 in YARP 3, float32 in YARP 4
  kBlob = 12,
  kInt64 = 17,
  kVocab64 = 18,  // YARP 4
  kFloat64Of4 = 20,
  kInt8 = 32,
  kInt16 = 64,
  kFloat32Of3 = 128,
  kList = 256,
};

std::string VocabText(std::string_view bytes) {
  return std::string(bytes.substr(0, std::min(bytes.find('\0'), bytes.size())));
}

/// Reads a Bottle with the tags of one dialect.
class Reader {
 public:
  Reader(std::string_view bytes, YarpDialect dialect) : bytes_(bytes), dialect_(dialect) {}

  std::optional<Bottle> Whole() {
    const std::optional<std::int32_t> tag = bytes_.Take<std::int32_t>();
    if (!tag || !IsList(*tag)) return {};
    std::optional<Bottle> bottle = Items(*tag - kList, 0);
    return bottle && bytes_.size() == 0 ? std::move(bottle) : std::nullopt;
  }
  bool saw_float() const { return saw_float_; }

 private:
  static bool IsList(std::int32_t tag) { return tag >= kList && tag < 2 * kList; }

  std::optional<Bottle> Items(std::int32_t common_tag, std::size_t depth) {
    const std::optional<std::int32_t> count = bytes_.Take<std::int32_t>();
    // Each item needs at least one byte.
    if (!count || *count < 0 || static_cast<std::size_t>(*count) > bytes_.size() || depth > kMaxBottleDepth)
      return {};
    Bottle items;
    for (std::int32_t i = 0; i < *count; ++i) {
      const std::optional<std::int32_t> tag = common_tag != 0 ? common_tag : bytes_.Take<std::int32_t>();
      if (!tag) return {};
      std::optional<BottleValue> item = Item(*tag, depth);
      if (!item) return {};
      items.push_back(std::move(*item));
    }
    return items;
  }

  std::optional<BottleValue> Item(std::int32_t tag, std::size_t depth) {
    if (IsList(tag)) {
      std::optional<Bottle> list = Items(tag - kList, depth + 1);
      return list ? std::optional(BottleValue{std::move(*list)}) : std::nullopt;
    }
    const bool four = dialect_ == YarpDialect::k4;
    switch (tag) {
      case kInt8:
        return Number<std::int8_t, std::int32_t>();
      case kInt16:
        return Number<std::int16_t, std::int32_t>();
      case kInt32:
        return Number<std::int32_t, std::int32_t>();
      case kInt64:
        return Number<std::int64_t, std::int64_t>();
      case kTen:
        return four ? Float<float>() : Float<double>();
      case kFloat64Of4:
        return four ? Float<double>() : std::nullopt;
      case kFloat32Of3:
        return four ? std::nullopt : Float<float>();
      case kVocab32:
        return Vocab(4);
      case kVocab64:
        return four ? Vocab(8) : std::nullopt;
      case kString:
      case kBlob:
        return Text(tag);
      default:
        return {};
    }
  }

  template <typename Wire, typename Kept>
  std::optional<BottleValue> Number() {
    const std::optional<Wire> number = bytes_.Take<Wire>();
    return number ? std::optional(BottleValue{static_cast<Kept>(*number)}) : std::nullopt;
  }
  template <typename Wire>
  std::optional<BottleValue> Float() {
    saw_float_ = true;
    return Number<Wire, double>();
  }
  std::optional<BottleValue> Vocab(std::int64_t size) {
    const std::optional<std::string_view> bytes = bytes_.TakeBytes(size);
    return bytes ? std::optional(BottleValue{YarpVocab{VocabText(*bytes)}}) : std::nullopt;
  }
  std::optional<BottleValue> Text(std::int32_t tag) {
    const std::optional<std::int32_t> size = bytes_.Take<std::int32_t>();
    std::optional<std::string_view> bytes = size ? bytes_.TakeBytes(*size) : std::nullopt;
    if (!bytes) return {};
    if (tag == kBlob) return BottleValue{YarpBlob{std::string(*bytes)}};
    if (bytes->ends_with('\0')) bytes->remove_suffix(1);  // old programs count it
    return BottleValue{std::string(*bytes)};
  }

  ByteScanner bytes_;
  const YarpDialect dialect_;
  bool saw_float_ = false;
};

class Writer {
 public:
  Writer(YarpDialect dialect, std::string& out) : dialect_(dialect), out_(out) {}

  void List(const Bottle& bottle) {
    const std::int32_t common = CommonTag(bottle);
    AppendBytes(kList + common, out_);
    AppendBytes(static_cast<std::int32_t>(bottle.size()), out_);
    for (const BottleValue& item : bottle) {
      if (const Bottle* const list = item.As<Bottle>()) {
        List(*list);
        continue;
      }
      if (common == 0) AppendBytes(TagOf(item), out_);
      std::visit([this](const auto& value) { Write(value); }, item.value);
    }
  }

 private:
  std::int32_t TagOf(const BottleValue& item) const {
    const std::int32_t float64 = dialect_ == YarpDialect::k4 ? kFloat64Of4 : kTen;
    const std::int32_t tags[] = {kInt32, kInt64, float64, kString, kVocab32, kBlob, kList};
    return tags[item.value.index()];
  }
  /// 0 if the tags differ or the items are lists.
  std::int32_t CommonTag(const Bottle& bottle) const {
    if (bottle.empty() || bottle.front().As<Bottle>() != nullptr) return 0;
    const auto same = [&](const BottleValue& item) {
      return item.value.index() == bottle.front().value.index();
    };
    return std::all_of(bottle.begin(), bottle.end(), same) ? TagOf(bottle.front()) : 0;
  }

  void Write(std::int32_t value) { AppendBytes(value, out_); }
  void Write(std::int64_t value) { AppendBytes(value, out_); }
  void Write(double value) { AppendBytes(value, out_); }
  void Write(const std::string& text) {
    AppendBytes(static_cast<std::int32_t>(text.size()), out_);
    out_ += text;
  }
  void Write(const YarpBlob& blob) { Write(blob.bytes); }
  void Write(const YarpVocab& vocab) {
    std::string four = vocab.text.substr(0, 4);
    four.resize(4, '\0');
    out_ += four;
  }
  void Write(const Bottle& /*list*/) {}  // done by List()

  const YarpDialect dialect_;
  std::string& out_;
};

}  // namespace

std::optional<double> NumberOf(const BottleValue& value) {
  if (const auto* const whole = value.As<std::int32_t>()) return *whole;
  if (const auto* const large = value.As<std::int64_t>()) return static_cast<double>(*large);
  if (const auto* const real = value.As<double>()) return *real;
  return {};
}

std::string_view WordAt(const Bottle& bottle, std::size_t at) {
  return at < bottle.size() ? bottle[at].word() : std::string_view();
}

std::int32_t VocabCode(std::string_view word) {
  std::int32_t code = 0;
  std::memcpy(&code, word.data(), std::min(word.size(), sizeof code));
  return code;
}

std::string_view BottleValue::word() const {
  if (const std::string* const text = As<std::string>()) return *text;
  if (const YarpVocab* const vocab = As<YarpVocab>()) return vocab->text;
  return {};
}

std::optional<Bottle> DecodeBottle(std::string_view bytes, YarpDialect& dialect) {
  const YarpDialect other = dialect == YarpDialect::k3 ? YarpDialect::k4 : YarpDialect::k3;
  for (const YarpDialect tried : {dialect, other}) {
    Reader reader(bytes, tried);
    std::optional<Bottle> bottle = reader.Whole();
    if (!bottle) continue;
    if (reader.saw_float()) dialect = tried;
    return bottle;
  }
  return {};
}

void EncodeBottle(const Bottle& bottle, YarpDialect dialect, std::string& out) {
  Writer(dialect, out).List(bottle);
}

}  // namespace coopdyn
