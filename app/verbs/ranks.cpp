/// The letters between ranks.
#include "app/verbs/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>

#include "core/error.hpp"
#include "core/files.hpp"
#include "core/stop.hpp"
#include "core/workers.hpp"

namespace rosin::app::verbs {

using analysis::planes::Group;
using analysis::planes::Queue;
using analysis::planes::Report;

namespace {

enum Errand : int { ask = 1, group, report, failure, end, farewell };

constexpr auto look_every = std::chrono::milliseconds(2);  ///< at letters: each look takes some tens of microseconds
constexpr auto patience = std::chrono::seconds(5);         ///< with ranks that are to end

void put(std::string& text, const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); }

template <class T>
T get(std::string_view& text) {
  T value{};
  if (text.size() < sizeof value) throw std::runtime_error("a letter between ranks is too short");
  std::memcpy(&value, text.data(), sizeof value);
  text.remove_prefix(sizeof value);
  return value;
}

std::string text_of(const Group& group) {
  std::string text;
  put(text, std::uint64_t(group.number));
  for (const std::size_t part : group.parts) put(text, std::uint64_t(part));
  return text;
}

Group group_of(std::string_view text) {
  Group group{std::size_t(get<std::uint64_t>(text)), {}};
  while (!text.empty()) group.parts.push_back(std::size_t(get<std::uint64_t>(text)));
  return group;
}

std::string text_of(const Report& what, const RecordForm& form) {
  std::string text;
  put(text, std::uint64_t(what.group)), put(text, what.work), put(text, std::uint8_t(what.finished));
  for (const auto& [index, point] : what.points) form.append(text, index, point);
  for (const auto& cost : what.costs) form.append(text, cost);
  return text;
}

Report report_of(std::string_view text, const RecordForm& form) {
  Report what;
  what.group = std::size_t(get<std::uint64_t>(text));
  what.work = get<double>(text);
  what.finished = get<std::uint8_t>(text) != 0;
  while (!text.empty()) {
    const auto found = form.find(text);
    if (found.length == 0) throw std::runtime_error("a record in a letter between ranks is damaged");
    if (found.cost)
      what.costs.push_back(*found.cost);
    else
      what.points.emplace_back(found.index, form.point(text.substr(0, found.length)));
    text.remove_prefix(found.length);
  }
  return what;
}

std::optional<int> number_in_environment(const char* name) {
  const char* text = std::getenv(name);
  if (!text) return std::nullopt;
  char* rest = nullptr;
  const long number = std::strtol(text, &rest, 10);
  if (rest == text || *rest || number < 0 || number > 100'000'000) return std::nullopt;
  return int(number);
}

}  // namespace

std::optional<Launch> launched() {
  for (const auto& [size, rank] : {std::pair{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"}, {"PMI_SIZE", "PMI_RANK"}})
    if (const auto processes = number_in_environment(size)) {
      if (*processes < 2) return std::nullopt;
      return Launch{number_in_environment(rank).value_or(0), *processes};
    }
  if (const auto rank = number_in_environment("PMIX_RANK")) return Launch{*rank, 0};
  return std::nullopt;
}

/// The queue of rank 0 as another process has it: threads leave letters here, which the main thread carries.
class Ranks::Remote : public Queue {
 public:
  /// `name`: by which rank 0 knows that it is of the same plane.
  Remote(std::string name, const RecordForm& form, int threads)
      : name_(std::move(name)), form_(form), threads_(threads) {}

  Group next() override {
    std::unique_lock lock(mutex_);
    outgoing_.push_back({0, ask, name_});
    changed_.notify_all();
    if (!changed_.wait(lock, Listening::token(), [&] { return !incoming_.empty(); })) throw Stopped{};
    Group next = std::move(incoming_.front());
    incoming_.pop_front();
    return next;
  }
  void take(Report what) override {
    auto text = text_of(what, form_);
    const std::scoped_lock lock(mutex_);
    outgoing_.push_back({0, report, std::move(text)});
    changed_.notify_all();
  }

  /// One thread less will come.
  void left() {
    const std::scoped_lock lock(mutex_);
    --threads_;
    changed_.notify_all();
  }
  /// The letters that wait, after a while if none does.
  std::deque<Letter> outgoing() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, look_every, [&] { return !outgoing_.empty(); });
    return std::exchange(outgoing_, {});
  }
  void arrived(Group next) {
    const std::scoped_lock lock(mutex_);
    incoming_.push_back(std::move(next));
    changed_.notify_all();
  }
  bool finished() {
    const std::scoped_lock lock(mutex_);
    return threads_ == 0 && outgoing_.empty();
  }

 private:
  const std::string name_;
  const RecordForm& form_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Letter> outgoing_;
  std::deque<Group> incoming_;
  int threads_;
};

Ranks::Ranks(std::unique_ptr<Mail> mail) : mail_(std::move(mail)) {}

void Ranks::begin(const std::string& key, RecordForm form) {
  key_ = checksum(key);
  form_.emplace(std::move(form));
}

void Ranks::work(Queue& whole, int threads, const std::function<void(Queue&)>& compute) {
  if (leads()) {
    std::atomic<bool> handed_out = false;
    return in_threads(threads + 1, [&](int t) {
      if (t == 0) return serve(whole, handed_out);
      compute(whole);  // until there is nothing left
      handed_out = true;
    });
  }
  Remote remote(fmt::format("{:016x} {}", key_, mail_->machine()), *form_, threads);
  const auto send_all = [&] {
    for (const auto& letter : remote.outgoing()) mail_->send(0, letter.kind, letter.text);
  };
  try {
    in_threads(threads + 1, [&](int t) {
      if (t == 0) {
        for (; !remote.finished(); relay(remote)) send_all();
        return;
      }
      struct Leaving {
        Remote& remote;
        ~Leaving() { remote.left(); }
      } const leaving{remote};
      compute(remote);
    });
  } catch (...) {
    send_all();  // what was finished before
    throw;
  }
}

void Ranks::relay(Remote& remote) {
  while (const auto letter = mail_->receive()) {
    if (letter->kind == group) remote.arrived(group_of(letter->text));
    if (letter->kind != end) continue;
    ended_ = true;
    throw Stopped{};
  }
}

void Ranks::serve(Queue& queue, const std::atomic<bool>& handed_out) {
  try {
    while (true) {
      end_if_stopped();
      if (const auto letter = mail_->receive())
        answer(*letter, &queue);
      else if (handed_out && at_work_.empty())
        return;
      else
        std::this_thread::sleep_for(look_every);
    }
  } catch (...) {
    end_others(&queue);
    throw;
  }
}

void Ranks::answer(const Letter& letter, Queue* queue) {
  switch (Errand(letter.kind)) {
    case ask: {
      if (ended_) return;
      const auto key = fmt::format("{:016x} ", key_);
      if (!letter.text.starts_with(key))
        throw InputError(fmt::format(
            "rank {} on {} has another scene, other settings or another version of rosin than rank 0; start all with "
            "the same, or, where each computes a plane of its own, by 'env -u OMPI_COMM_WORLD_SIZE -u PMI_SIZE -u "
            "PMIX_RANK rosin map …'",
            letter.from, letter.text.substr(std::min(key.size(), letter.text.size()))));
      const Group next = queue->next();
      if (!next.parts.empty()) at_work_[next.number] = letter.from;
      return mail_->send(letter.from, group, text_of(next));
    }
    case report: {
      if (!queue) return;
      auto what = report_of(letter.text, *form_);
      if (what.finished) at_work_.erase(what.group);
      return queue->take(std::move(what));
    }
    case failure:
      if (!ended_) throw InputError(fmt::format("rank {} on {}", letter.from, letter.text));
      return;
    case farewell:
      gone_.insert(letter.from);
      if (!ended_ && std::ranges::any_of(at_work_, [&](const auto& one) { return one.second == letter.from; }))
        throw Stopped{};  // that process was asked to stop, and so are all
      return;
    case group:
    case end:
      return;
  }
}

bool Ranks::end_others(Queue* queue) {
  if (!ended_)
    for (int rank = 1; rank < mail_->size(); ++rank) mail_->send(rank, end, "");
  ended_ = true;
  const auto until = std::chrono::steady_clock::now() + patience;
  while (int(gone_.size()) < mail_->size() - 1) {
    if (const auto letter = mail_->receive())
      answer(*letter, queue);
    else if (std::chrono::steady_clock::now() > until)
      return false;
    else
      std::this_thread::sleep_for(look_every);
  }
  return true;
}

void Ranks::fail(const std::string& why) { mail_->send(0, failure, fmt::format("{}: {}", mail_->machine(), why)); }

void Ranks::part() {
  if (parted_) return;
  if (leads()) {
    if (!end_others(nullptr)) return;
  } else {
    mail_->send(0, farewell, "");
    while (!ended_) {
      const auto letter = mail_->receive();
      ended_ |= letter && letter->kind == end;
      if (!letter) std::this_thread::sleep_for(look_every);
    }
  }
  parted_ = true;
  mail_->leave();
}

Ranks::~Ranks() {
  part();
  if (!parted_) mail_->end_all(1);  // some rank does not answer
}

}  // namespace rosin::app::verbs
