// SPDX-License-Identifier: BSD-3-Clause
// Nothing but the place where the headers that all tests include are compiled once; see tests/CMakeLists.txt.
