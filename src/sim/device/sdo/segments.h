// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/sdo/channel.h"

namespace cia402::sim {

/// Expedited and segmented transfers of a simulated SDO server (CiA 301, 7.2.4.3.3 to 7.2.4.3.7).
class SdoSegments {
 public:
  explicit SdoSegments(SdoChannel& channel) : channel_(channel) {}

  // Requests of the client, by their command specifier.
  /// A download begins; an expedited one ends with it.
  void initiateDownload(const can::Frame& request);
  /// Takes a segment.
  void downloadSegment(const can::Frame& request);
  /// An upload begins; an expedited one ends with it.
  void initiateUpload(const can::Frame& request);
  /// Answers with the next segment.
  void uploadSegment(const can::Frame& request);

  /// Answers an upload whose value is in the channel: at once, or in segments to be asked for.
  void answerUpload();

 private:
  void downloadExpedited(const can::Frame& request);
  void finishDownload();
  void confirmSegment();
  bool toggleFits(const can::Frame& request);

  SdoChannel& channel_;
  bool toggle_ = false;  ///< of the next request
};

}  // namespace cia402::sim
