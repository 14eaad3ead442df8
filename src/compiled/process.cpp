// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/process_stages.hpp>

agrisee::ScanResult agrisee::detail::process_finite(Cloud raw, const Parameters& parameters, const CloudOrigin& origin,
                                                    const SeenThrough& seen_through, int threads) {
  return run_stages(std::move(raw), parameters, origin, seen_through, threads);
}
