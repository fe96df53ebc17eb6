// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/image.h"
#include "input.h"

// The process image with any mapping and any frames. An output that is packed into a frame and
// unpacked by the same mapping as an input must be the same number.
namespace cia402::fuzz {
namespace {

using namespace canopen;

std::vector<PdoConfig> readMapping(Input& input) {
  std::vector<PdoConfig> pdos(input.byte() % 9);
  for (PdoConfig& pdo : pdos) {
    const std::uint8_t shape = input.byte();
    pdo.direction = (shape & 1U) != 0 ? PdoDirection::rpdo : PdoDirection::tpdo;
    pdo.enabled = (shape & 2U) == 0;
    pdo.number = input.byte();
    pdo.cob_id = static_cast<std::uint16_t>(input.word() & 0x7FFU);
    pdo.transmission = input.byte();
    pdo.entries.resize((shape >> 2U) % 12);
    for (PdoEntry& entry : pdo.entries) {
      entry.object = {static_cast<std::uint16_t>(0x2000 + input.byte() % 8),
                      static_cast<std::uint8_t>(input.byte() % 4)};
      entry.bits = input.byte();
    }
  }
  return pdos;
}

void checkLayout(const PdoImage::Pdo& pdo) {
  unsigned bits = 0;
  for (const PdoImage::Pdo::Field& field : pdo.fields) {
    require(field.bits >= 1 && field.shift == bits, "fields follow each other");
    bits += field.bits;
  }
  require(bits <= 64 && pdo.size == (bits + 7) / 8, "a PDO has at most 8 bytes");
}

}  // namespace
}  // namespace cia402::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  fuzz::Input input(data, size);
  std::vector<canopen::PdoConfig> mapping = fuzz::readMapping(input);
  canopen::PdoImage image(mapping);
  // The other end: what the one sends is what the other receives.
  for (canopen::PdoConfig& pdo : mapping) {
    pdo.direction = pdo.direction == canopen::PdoDirection::rpdo ? canopen::PdoDirection::tpdo
                                                                 : canopen::PdoDirection::rpdo;
  }
  canopen::PdoImage mirror(mapping);
  for (const auto& pdo : image.tpdos()) fuzz::checkLayout(pdo);
  for (const auto& pdo : image.rpdos()) fuzz::checkLayout(pdo);
  fuzz::require(image.rpdos().size() == mirror.tpdos().size(), "both ends have the same PDOs");

  Time now{};
  while (!input.empty()) {
    const std::uint8_t action = input.byte();
    now += std::chrono::microseconds(input.byte());
    if (action < 0x60 && !image.tpdos().empty()) {
      const std::size_t pdo = action % image.tpdos().size();
      const can::Frame frame = input.frame(image.tpdos()[pdo].cob_id);
      const auto wrong = [&] { return image.tpdos()[pdo].too_short + image.tpdos()[pdo].too_long; };
      const std::uint64_t before = wrong();
      const bool exact = image.receive(pdo, frame, now);
      fuzz::require(exact == (wrong() == before), "a wrong length is counted");
    } else if (action < 0xC0 && !image.rpdos().empty()) {
      const std::size_t pdo = action % image.rpdos().size();
      for (const auto& field : image.rpdos()[pdo].fields) image.setOutput(field.slot, input.word());
      can::Frame frame;
      image.pack(pdo, frame);
      fuzz::require(frame.size == image.rpdos()[pdo].size, "a packed PDO has its length");
      fuzz::require(mirror.receive(pdo, frame, now), "the other end takes it");
      for (std::size_t i = 0; i < image.rpdos()[pdo].fields.size(); ++i) {
        const auto& sent = image.rpdos()[pdo].fields[i];
        const auto& received = mirror.tpdos()[pdo].fields[i];
        bool later = false;  // an object twice in a PDO: the last field counts
        for (std::size_t k = i + 1; k < mirror.tpdos()[pdo].fields.size(); ++k) {
          later = later || mirror.tpdos()[pdo].fields[k].slot == received.slot;
        }
        if (later) continue;
        const std::uint64_t mask = ~std::uint64_t{0} >> (64U - sent.bits);
        fuzz::require(mirror.input(received.slot).raw == (image.output(sent.slot) & mask),
                      "a number arrives as it was sent");
      }
    } else if (action < 0xE0) {
      image.age(now);
      for (const std::size_t tpdo : image.requested()) {
        can::Frame frame;
        if (image.requestDue(tpdo, frame)) fuzz::require(frame.remote, "a request is remote");
      }
    } else if (action < 0xF0 && !image.rpdos().empty()) {
      can::Frame frame;
      image.packDue(action % image.rpdos().size(), frame, now);
    } else if (action == 0xFF) {
      image.invalidate();
    }
  }
  return 0;
}
