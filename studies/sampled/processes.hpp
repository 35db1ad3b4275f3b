// Work that a process can do only one of at a time, such as a simulation of SystemC, done in several at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raypool::sampled {

/// work(0) .. work(tasks - 1), each in a forked process of its own that has all this one has and changes nothing of it;
/// so many at a time, begun in this order. Returns what each returned. `done` is called with a task's number and what
/// it returned as soon as it has; may be empty. No thread of this process may hold what the work needs, such as a lock.
/// Throws InputError with the message of an InputError in `work`, std::runtime_error with that of another exception or
/// with how a process ended otherwise; all others are ended then.
std::vector<std::string> in_processes(size_t tasks, uint32_t at_a_time, const std::function<std::string(size_t)>& work,
                                      const std::function<void(size_t, const std::string&)>& done = {});

}  // namespace raypool::sampled
