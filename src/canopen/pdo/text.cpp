// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/text.h"

#include "common/text.h"

namespace cia402::canopen {

std::string pdoName(const PdoImage::Pdo& pdo) {
  if (!pdo.carrier.empty()) return pdo.carrier;
  return (pdo.direction == PdoDirection::tpdo ? "TPDO " : "RPDO ") + std::to_string(pdo.number) +
         " (COB-ID " + hexText(pdo.cob_id, 3) + ")";
}

std::string staleText(const PdoImage& image) {
  std::string text;
  for (const PdoImage::Pdo& pdo : image.tpdos()) {
    if (!pdo.stale) continue;
    append(text, pdoName(pdo) + " did not come for " + std::to_string(pdo.silent) + " cycles",
           ", ");
  }
  return text;
}

std::string missingText(const PdoImage& image) {
  std::string text;
  for (const PdoImage::Pdo& pdo : image.tpdos()) {
    if (!pdo.stale) continue;
    append(text, pdoName(pdo), ", ");
    text += pdo.last_too_short ? " comes too short (" + std::to_string(pdo.wrong_size) +
                                     " bytes instead of " + std::to_string(pdo.size) + ")"
                               : " does not come";
  }
  return text;
}

std::string wrongLengthText(const PdoImage& image) {
  std::string text;
  for (const PdoImage::Pdo& pdo : image.tpdos()) {
    const std::uint64_t count = pdo.too_short + pdo.too_long;
    if (count == 0) continue;
    const bool short_one = pdo.wrong_size < pdo.size;
    append(text, pdoName(pdo), ", ");
    text += " came with " + std::to_string(pdo.wrong_size) + " bytes instead of " +
            std::to_string(pdo.size) +
            (short_one ? ": too short, not taken (" : ": too long, its beginning was taken (") +
            std::to_string(count) + " so far)";
  }
  return text;
}

}  // namespace cia402::canopen
