// The list of effects that a diagnosis may name, in the names of result.json.
#include "test/sealed/mechanisms/sensor_mechanisms.hpp"
#include "test/sealed/mechanisms/site_mechanisms.hpp"
#include "test/sealed/mechanisms/thrust_mechanisms.hpp"
#include "test/sealed/mechanisms/water_mechanisms.hpp"

namespace fathom::sealed {

const std::vector<Entry>& catalogue() {
  static const std::vector<Entry> list = [] {
    std::vector<Entry> all;
    for (const auto& part : {water_mechanisms(), thrust_mechanisms(), site_mechanisms(), sensor_mechanisms()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  }();
  return list;
}

const Entry* find_entry(const std::string& name) {
  for (const auto* list : {&catalogue(), &foreign(), &further(), &unlisted(), &surface_entries(), &surface_foreign()}) {
    for (const Entry& entry : *list) {
      if (entry.name == name) return &entry;
    }
  }
  return coloured_noise().name == name ? &coloured_noise() : nullptr;
}

}  // namespace fathom::sealed
