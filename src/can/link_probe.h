// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cia402::can {

/// What the kernel says about a network interface.
struct Link {
  bool exists = false;
  bool up = false;
  bool running = false;  ///< has a carrier; a controller in bus-off has none
  int index = 0;         ///< another one after the interface was removed and created again
};

/// Looks at network interfaces by name.
class LinkProbe {
 public:
  LinkProbe();
  ~LinkProbe();
  LinkProbe(const LinkProbe&) = delete;
  LinkProbe& operator=(const LinkProbe&) = delete;

  /// For an interface that was there the last time: does not wait for anything. (For one that is
  /// not there the kernel may try to load a module, which can take milliseconds.)
  Link look(const std::string& name) const;
  /// Whether the interface exists, without an attempt to load a module for it; may wait while
  /// another process configures interfaces.
  bool exists(const std::string& name) const;
  /// Whether the interface is there and speaks CAN.
  bool isCan(const std::string& name) const;

 private:
  int ioctl_socket_;
  int netlink_;
};

}  // namespace cia402::can
