// A file that all ranks of a communicator write or read at once, by MPI-IO. Every call is made by all ranks, and what fails on
// one of them is thrown on all.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>

namespace motley {

/// MPI's name for a struct that is sent or written as its bytes.
template <class Record>
class RecordType {
  public:
    RecordType()
    {
        MPI_Type_contiguous(sizeof(Record), MPI_BYTE, &type_);
        MPI_Type_commit(&type_);
    }
    ~RecordType() { MPI_Type_free(&type_); }
    RecordType(const RecordType&) = delete;
    RecordType& operator=(const RecordType&) = delete;
    [[nodiscard]] MPI_Datatype get() const { return type_; }

  private:
    MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

class SharedFile {
  public:
    enum class Use { read, write };
    /// A file to be written is `path`.part until finish(), and is removed if it comes to that no more.
    SharedFile(MPI_Comm comm, const std::string& path, Use use) : comm_(comm), path_(path)
    {
        MPI_Comm_rank(comm, &rank_);
        if (use == Use::write) {
            part_ = path + ".part";
            if (rank_ == 0) std::remove(part_.c_str());  // that of an earlier run may be longer
            MPI_Barrier(comm);
        }
        const int mode = use == Use::read ? MPI_MODE_RDONLY : MPI_MODE_CREATE | MPI_MODE_WRONLY;
        require(MPI_File_open(comm, use == Use::read ? path.c_str() : part_.c_str(), mode, MPI_INFO_NULL,
                              &file_) == MPI_SUCCESS,
                use == Use::read ? "cannot be opened" : "cannot be written");
    }
    ~SharedFile()
    {
        if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
        if (!part_.empty() && rank_ == 0) std::remove(part_.c_str());
    }
    SharedFile(const SharedFile&) = delete;
    SharedFile& operator=(const SharedFile&) = delete;

    /// At byte `at` of the file.
    template <class Record>
    void write(std::uint64_t at, std::span<const Record> records)
    {
        const RecordType<Record> type;
        require(MPI_File_write_at_all(file_, static_cast<MPI_Offset>(at), records.data(),
                                      static_cast<int>(records.size()), type.get(),
                                      MPI_STATUS_IGNORE) == MPI_SUCCESS,
                "cannot be written");
    }
    template <class Record>
    void read(std::uint64_t at, std::span<Record> records)
    {
        const RecordType<Record> type;
        require(MPI_File_read_at_all(file_, static_cast<MPI_Offset>(at), records.data(),
                                     static_cast<int>(records.size()), type.get(),
                                     MPI_STATUS_IGNORE) == MPI_SUCCESS,
                "cannot be read");
    }
    [[nodiscard]] std::uint64_t size()
    {
        MPI_Offset bytes = 0;
        require(MPI_File_get_size(file_, &bytes) == MPI_SUCCESS, "cannot be read");
        return static_cast<std::uint64_t>(bytes);
    }
    /// Puts the file in its place, once its bytes are on the disk.
    void finish()
    {
        const bool is_written = MPI_File_sync(file_) == MPI_SUCCESS;
        const bool is_closed = MPI_File_close(&file_) == MPI_SUCCESS;
        require(is_written && is_closed, "cannot be written");
        require(rank_ != 0 || std::rename(part_.c_str(), path_.c_str()) == 0, "cannot be written");
        part_.clear();
    }
    /// Throws on all ranks unless something is so on all of them.
    void require(bool is_so, const char* otherwise) const
    {
        int all = is_so ? 1 : 0;
        MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_LAND, comm_);
        if (all == 0) throw std::runtime_error(path_ + ": " + otherwise);
    }

  private:
    MPI_Comm comm_;
    std::string path_, part_;  ///< `part_` is empty once there is none
    int rank_ = 0;
    MPI_File file_ = MPI_FILE_NULL;
};

}  // namespace motley
