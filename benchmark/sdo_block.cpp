// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How much of the bus a block transfer uses.
#include <random>
#include <stdexcept>

#include "figures.h"
#include "sim/bus/bit_timing.h"
#include "tools/sdo_bus.h"

namespace cia402::benchmark {
namespace {

constexpr fieldbus::ObjectId kObject{0x1F50, 1};
constexpr std::size_t kSize = 1'000'000;  // bytes
constexpr std::size_t kSegmentBytes = 7;

fieldbus::Bytes randomBytes() {
  std::mt19937 random(1);
  fieldbus::Bytes data(kSize);
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
  return data;
}

/// Bits of all segments on the wire, each with its true stuff bits, and of nothing else. `id`:
/// whose identifier they carry.
double segmentTime(const fieldbus::Bytes& data, std::uint32_t id, double bitrate) {
  std::uint64_t bits = 0;
  unsigned sequence = 0;
  for (std::size_t at = 0; at < data.size(); at += kSegmentBytes) {
    sequence = sequence % 127 + 1;
    can::Frame frame(id, {0, 0, 0, 0, 0, 0, 0, 0});
    const bool last = at + kSegmentBytes >= data.size();
    frame.data[0] = static_cast<std::uint8_t>(sequence | (last ? 0x80U : 0U));
    for (std::size_t i = 0; i < kSegmentBytes && at + i < data.size(); ++i) {
      frame.data[1 + i] = data[at + i];
    }
    bits += sim::exactBits(frame);
  }
  return static_cast<double>(bits) / bitrate;
}

int measure(const char* name, bool download) {
  const fieldbus::Bytes data = randomBytes();
  tools::SdoBus bus;
  bus.addDomain(kObject, download ? fieldbus::Bytes() : data);
  bus.start();
  canopen::SdoOptions options;
  options.block = canopen::SdoOptions::Block::always;
  const canopen::SdoTicket ticket = download ? bus.client().download(kObject, data, "", options)
                                             : bus.client().upload(kObject, "", options);
  const Duration took = bus.finish(ticket);
  const fieldbus::Bytes& arrived =
      download ? bus.dictionary().find(kObject)->bytes : ticket->data();
  if (!ticket->ok() || arrived != data) {
    throw std::runtime_error("the transfer failed: " + ticket->message());
  }
  const std::uint32_t id = download ? bus.client().requestId() : bus.client().answerId();
  print(name, segmentTime(data, id, bus.bus().bitrate()) / toSeconds(took), "ratio");
  return 0;
}

}  // namespace

int sdoBlockDownload() { return measure("sdo_block_download", true); }
int sdoBlockUpload() { return measure("sdo_block_upload", false); }

}  // namespace cia402::benchmark
