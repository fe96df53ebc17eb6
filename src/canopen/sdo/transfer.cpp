// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/transfer.h"

#include <algorithm>
#include <utility>

#include "common/text.h"

namespace cia402::canopen {
namespace {

/// The first of them, and how many there are.
std::string shownBytes(const Bytes& bytes) {
  constexpr std::size_t kShown = 8;
  std::string text = hexBytes(bytes.data(), std::min(bytes.size(), kShown));
  if (bytes.size() > kShown) text += " ... (" + std::to_string(bytes.size()) + " bytes)";
  return text;
}

}  // namespace

SdoTransfer::SdoTransfer(Direction direction, ObjectId object, std::string name, Bytes data,
                         const SdoOptions& options, bool urgent)
    : options_(options), urgent_(urgent) {
  direction_ = direction;
  object_ = object;
  name_ = std::move(name);
  data_ = std::move(data);
}

void SdoTransfer::fail(NodeId node, Failure failure, std::uint32_t code, std::string reason) {
  done_ = true;
  failure_ = failure;
  abort_code_ = code;
  reason_ = std::move(reason);
  std::string what = "node " + std::to_string(node) + ", object " + toString(object_);
  if (!name_.empty()) what += " " + name_;
  what += isUpload() ? std::string(", read") : ", write " + shownBytes(data_);
  message_ = what + ": " + reason_;
}

}  // namespace cia402::canopen
