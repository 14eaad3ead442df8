// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/process.hpp>
#include <agrisee/version.hpp>
#ifdef WITH_IO
#include <agrisee/io/parameters.hpp>
#endif

int main() {
  const agrisee::ScanResult result = agrisee::process(agrisee::Cloud{});
#ifdef WITH_IO
  if (agrisee::io::parameters_to_yaml(agrisee::Parameters::paper()).find("preset: paper") == std::string::npos) return 2;
#endif
  return result.fruits.empty() && AGRISEE_VERSION[0] != '\0' ? 0 : 1;
}
