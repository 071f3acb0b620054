/// The one file that knows MPI, and that is built without it too: part of the command, not of the library.
#include "app/mpi.hpp"

#include "app/verbs/mail.hpp"

#ifdef ROSIN_MPI
// Only C: the C++ bindings are another library.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <cstdlib>
#endif

namespace rosin::app {

#ifdef ROSIN_MPI

namespace {

class MpiMail : public verbs::Mail {
 public:
  MpiMail() {
    int level = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::string machine() const override {
    char name[MPI_MAX_PROCESSOR_NAME];
    int length = 0;
    MPI_Get_processor_name(name, &length);
    return {name, std::size_t(length)};
  }
  void send(int to, int kind, std::string_view text) override {
    MPI_Send(text.data(), int(text.size()), MPI_BYTE, to, kind, MPI_COMM_WORLD);
  }
  std::optional<verbs::Letter> receive() override {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (!there) return std::nullopt;
    int length = 0;
    MPI_Get_count(&status, MPI_BYTE, &length);
    verbs::Letter letter{status.MPI_SOURCE, status.MPI_TAG, std::string(std::size_t(length), '\0')};
    MPI_Recv(letter.text.data(), length, MPI_BYTE, letter.from, letter.kind, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return letter;
  }
  void leave() override { MPI_Finalize(); }
  [[noreturn]] void end_all(int status) override {
    MPI_Abort(MPI_COMM_WORLD, status);
    std::_Exit(status);
  }

 private:
  int rank_ = 0, size_ = 1;
};

}  // namespace

JoinProcesses mpi() {
  return []() -> std::unique_ptr<verbs::Mail> { return std::make_unique<MpiMail>(); };
}

#else

JoinProcesses mpi() { return nullptr; }

#endif

}  // namespace rosin::app
