// SPDX-License-Identifier: BSD-3-Clause
// A STAND-IN FOR ROS 2, written for this project's tests: just the names of rclcpp, rclcpp_lifecycle, rclcpp_components
// and tf2_ros that examples/ros2 uses, in one process, without threads, time or transport. What compiles and runs with
// it need not do so with ROS 2: only names, arguments and the behavior that is documented for ROS 2 were followed.
//
// This file: what a test sees. Messages are handed over at once, unless the executor is busy; time stands until the
// test moves it, timers go off and transforms change when the test says so.
#pragma once

#include <any>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

namespace stand_in {

/// How messages are handed over.
struct Qos {
  std::size_t depth = 10;
  bool reliable = true, transient_local = false;
};

struct Reader {
  Qos qos;
  std::type_index type;
  std::function<void(std::shared_ptr<const void>)> take;
  std::deque<std::shared_ptr<const void>> waiting;  ///< as many as the quality of service keeps
};
struct Writer {
  Qos qos;
  std::type_index type;
  std::shared_ptr<const void> last;  ///< kept for readers that come later, if it is transient local
};
struct Topic {
  std::vector<std::weak_ptr<Reader>> readers;
  std::vector<std::weak_ptr<Writer>> writers;
};

/// All that nodes and tests share.
struct Graph {
  std::map<std::string, Topic> topics;
  std::map<std::string, std::any> services;  ///< std::function of the service's callback
  std::vector<std::weak_ptr<std::function<void()>>> timers;
  std::map<std::string, std::function<std::shared_ptr<void>(const std::any& options)>> components;
  std::vector<std::string> log;
  std::int64_t now = 0;         ///< nanoseconds
  std::int64_t clock_step = 0;  ///< by which time goes on whenever a node looks at it (ns)
  bool busy = false;            ///< the executor is: messages wait until hand_over()
  /// The transform of two frames at a time (ns), as std::any of a TransformStamped; throws what tf2 throws.
  std::function<std::any(const std::string& target, const std::string& source, std::int64_t at)> transform;
};

/// Not destroyed at the end: nodes may outlive main.
inline Graph& graph() {
  static Graph* const all = new Graph;
  return *all;
}

/// As DDS has it: a reader gets nothing of a writer that offers less than it asks for.
inline bool compatible(const Writer& writer, const Reader& reader) {
  return writer.type == reader.type && (writer.qos.reliable || !reader.qos.reliable) &&
         (writer.qos.transient_local || !reader.qos.transient_local);
}

/// A name as a node says it: `~/x` is the node's own, `x` is that of its namespace, the root.
inline std::string resolved(const std::string& node, const std::string& name) {
  if (name.rfind("~/", 0) == 0) return "/" + node + name.substr(1);
  return name[0] == '/' ? name : "/" + name;
}

template <typename Message>
std::shared_ptr<Reader> subscribe(const std::string& topic, Qos qos,
                                  std::function<void(std::shared_ptr<const Message>)> callback) {
  auto reader = std::make_shared<Reader>(Reader{
      qos,
      typeid(Message),
      [callback](std::shared_ptr<const void> message) { callback(std::static_pointer_cast<const Message>(message)); },
      {}});
  Topic& all = graph().topics[topic];
  all.readers.push_back(reader);
  for (const auto& weak : all.writers)
    if (const auto writer = weak.lock())
      if (writer->last && reader->qos.transient_local && compatible(*writer, *reader)) reader->take(writer->last);
  return reader;
}

template <typename Message>
std::shared_ptr<Writer> advertise(const std::string& topic, Qos qos) {
  auto writer = std::make_shared<Writer>(Writer{qos, typeid(Message), nullptr});
  graph().topics[topic].writers.push_back(writer);
  return writer;
}

/// The readers that a writer reaches.
inline std::vector<std::shared_ptr<Reader>> readers(const std::string& topic, const Writer& writer) {
  std::vector<std::shared_ptr<Reader>> out;
  for (const auto& weak : graph().topics[topic].readers) {
    auto reader = weak.lock();
    if (reader && compatible(writer, *reader)) out.push_back(std::move(reader));
  }
  return out;
}

template <typename Message>
void publish(const std::string& topic, const std::shared_ptr<Writer>& writer, const Message& message) {
  const auto copy = std::make_shared<const Message>(message);
  if (writer->qos.transient_local) writer->last = copy;
  for (const auto& reader : readers(topic, *writer)) {
    if (!graph().busy) {
      reader->take(copy);
      continue;
    }
    reader->waiting.push_back(copy);
    if (reader->waiting.size() > reader->qos.depth) reader->waiting.pop_front();
  }
}

/// The executor is free again: hand over what waits.
inline void hand_over() {
  graph().busy = false;
  for (auto& entry : graph().topics)
    for (const auto& weak : entry.second.readers)
      if (const auto reader = weak.lock())
        for (; !reader->waiting.empty(); reader->waiting.pop_front()) reader->take(reader->waiting.front());
}

/// Let every timer that still exists go off once.
inline void fire_timers() {
  const auto all = graph().timers;
  for (const auto& weak : all)
    if (const auto timer = weak.lock()) (*timer)();
}

}  // namespace stand_in
