// SPDX-License-Identifier: BSD-3-Clause
#include "layout.hpp"

decltype(agrisee::test::kLayout) agrisee::test::plain_layout() { return kLayout; }
