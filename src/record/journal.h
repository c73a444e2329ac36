/* The journal beside a run file ("RUN.h5.journal"): what is to be changed of bytes that the file already has. Nothing of the file
   itself changes until the journal is on the disk, so that whatever ends the writer or the machine, at any time, the file
   and its journal together hold every whole frame that has reached the disk.

   A record holds the changes of one frame, the range of bytes that the frame has added at the end of the file, and a checksum of
   both; it counts when all records before it count. When it is time to settle, file and journal are brought to the disk, a mark
   is added to the journal, and then the changes are made in the file. A journal with a mark is carried out again from its first
   record, however far the writer had come; a journal without one is carried out as far as its records and the added bytes
   prove to be whole. */
#ifndef SHV_RECORD_JOURNAL_H
#define SHV_RECORD_JOURNAL_H

#include <stdbool.h>

#include "base/memory.h"

typedef struct ShvJournal ShvJournal;

/* Bytes of the file, at a fixed place, that tell which journal is its own. */
typedef struct ShvJournalBadge {
    uint64_t identity; /* of the writing; 0: no journal belongs to the file */
    uint64_t epoch;    /* how often a journal has been carried out */
} ShvJournalBadge;

/* Makes the journal of the file at `path`, open for reading and writing as `file`, and pins the badge at byte `place`. */
ShvStatus shv_journal_create(ShvJournal **journal, ShvMemory *memory, const char *path, int file, uint64_t place,
                             ShvError *error);
/* Both return an errno, 0: done. Appends a record: `changes` is a row of (address, size, bytes), and the file has grown from
   `from` to `to`. */
int shv_journal_append(ShvJournal *journal, uint64_t from, uint64_t to, const void *changes, size_t size);
/* Makes the changes of all records in the file, and empties the journal. */
int shv_journal_settle(ShvJournal *journal);
/* Bytes of all records. */
int64_t shv_journal_size(const ShvJournal *journal);
/* Removes the journal, after shv_journal_settle and with the badge cleared, or leaves it for the next reader. NULL is accepted. */
int shv_journal_finish(ShvJournal *journal);
void shv_journal_release(ShvJournal *journal);

/* Carries out the journal beside a file whose writer is gone; does nothing where there is none. `file` may be open for reading
   only when there is none. */
ShvStatus shv_journal_recover(const char *path, int file, ShvMemory *memory, ShvError *error);
/* Whether a journal lies beside the file. */
bool shv_journal_exists(const char *path);

/* What a journal says while its file is written. */
typedef struct ShvJournalView {
    ShvJournalBadge badge;  /* as the file has it; zeros where there is no journal yet, or none any more */
    bool marked;            /* the changes are being made in the file */
    unsigned char *changes; /* of all records that are not in the file yet: a row of (address, size, bytes) */
    size_t size;
} ShvJournalView;
/* Looks at the journal of a file that another process is writing, and changes nothing; returns an errno. The caller releases
   the changes. Between two looks of equal badges and marks no byte was changed of those that the file had. */
int shv_journal_inspect(const char *path, int file, ShvMemory *memory, ShvJournalView *view);
/* Puts what the changes say of the bytes [address, address + length) into the buffer. */
void shv_journal_lay(const unsigned char *changes, size_t size, uint64_t address, size_t length, void *buffer);

#endif
