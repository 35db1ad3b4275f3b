#include "chip/module_tree.hpp"

#include <cxxabi.h>
#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <set>
#include <systemc>
#include <tlm>
#include <typeindex>
#include <utility>
#include <vector>

namespace raypool::chip {

namespace {

using Objects = std::vector<sc_core::sc_object*>;

std::string type_name(const std::type_index& type) {
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(type.name(), nullptr, nullptr, nullptr),
                                                         std::free);
  const std::string name = text ? text.get() : type.name();
  const size_t end = name.find('<');  // of the name without the arguments of a template
  const size_t scope = name.rfind("::", end);
  return name.substr(scope == std::string::npos ? 0 : scope + 2, end == std::string::npos ? end : end - scope - 2);
}

class Tree {
 public:
  explicit Tree(const Objects& top) {
    for (const sc_core::sc_object* object : top) find_targets(*object);
    for (const sc_core::sc_object* object : top) show(*object, 0);
  }
  const std::string& text() const { return text_; }

 private:
  /// Exports and target sockets by what they lead to; and what is part of a socket, and is shown as that.
  void find_targets(const sc_core::sc_object& object) {
    const auto* socket = dynamic_cast<const tlm::tlm_base_socket_if*>(&object);
    const bool initiator = socket != nullptr && (socket->get_socket_category() & tlm::TLM_INITIATOR_SOCKET) != 0;
    if (socket != nullptr) {
      const sc_core::sc_object& other_half =
          initiator ? static_cast<const sc_core::sc_object&>(socket->get_base_export()) : socket->get_base_port();
      halves_.insert(&other_half);
    }
    if (const auto* target = dynamic_cast<const sc_core::sc_export_base*>(&object))
      targets_.emplace(channel(*target), &object);
    for (const sc_core::sc_object* child : object.get_child_objects()) find_targets(*child);
  }

  /// A module may be the channel of several interfaces, and has them in one place.
  using Channel = std::pair<const sc_core::sc_interface*, std::type_index>;
  template <typename PortOrExport>
  static Channel channel(const PortOrExport& from) {
    return {from.get_interface(), from.get_interface_type()};
  }

  std::string bound_to(const Channel& bound) const {
    if (bound.first == nullptr) return "nothing";
    const auto target = targets_.find(bound);
    if (target != targets_.end()) return target->second->name();
    const auto* object = dynamic_cast<const sc_core::sc_object*>(bound.first);
    return object == nullptr ? "a channel without a name" : object->name();
  }

  void show(const sc_core::sc_object& object, int depth) {
    const auto line = [&](const std::string& what) {
      text_ += fmt::format("{:<24}{}\n", std::string(2 * static_cast<size_t>(depth), ' ') + object.basename(), what);
    };
    if (halves_.count(&object) != 0) return;
    const auto* socket = dynamic_cast<const tlm::tlm_base_socket_if*>(&object);
    const std::string bits = socket == nullptr ? "" : fmt::format("socket, {} bits", socket->get_bus_width());
    if (const auto* port = dynamic_cast<const sc_core::sc_port_base*>(&object)) {
      line(fmt::format("{} -> {}",
                       socket == nullptr ? "port of " + type_name(port->get_interface_type()) : "initiator " + bits,
                       bound_to(channel(*port))));
    } else if (const auto* target = dynamic_cast<const sc_core::sc_export_base*>(&object)) {
      line(socket == nullptr ? "export of " + type_name(target->get_interface_type()) : "target " + bits);
    } else if (dynamic_cast<const sc_core::sc_module*>(&object) != nullptr) {
      line(type_name(typeid(object)));
    }
    for (const sc_core::sc_object* child : object.get_child_objects()) show(*child, depth + 1);
  }

  std::map<Channel, const sc_core::sc_object*> targets_;
  std::set<const sc_core::sc_object*> halves_;
  std::string text_;
};

}  // namespace

std::string module_tree() {
  // That nothing happens is what is wanted.
  sc_core::sc_report_handler::set_actions(sc_core::SC_ID_NO_SC_START_ACTIVITY_, sc_core::SC_DO_NOTHING);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  return Tree(sc_core::sc_get_top_level_objects()).text();
}

}  // namespace raypool::chip
