#include "record/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#include "base/hash.h"
#include "base/publish.h"
#include "base/text.h"
#include "record/disk.h"

/* "SHVJRNL1" as it lies in memory of this byte order: a journal of another machine is none. */
#define MAGIC UINT64_C(0x314c4e524a564853)

typedef enum Kind { KIND_FRAME, KIND_MARK } Kind;

/* In front of every record. The checksums are CRC-32. */
typedef struct Head {
    uint64_t magic, identity, place, epoch, sequence, kind;
    uint64_t from, to;       /* bytes that the file has grown by */
    uint64_t size;           /* bytes of the changes that follow */
    uint32_t added, changes; /* checksums of the bytes [from, to) of the file and of the changes */
    uint32_t previous, own;  /* checksums of the head before and of this one up to here */
} Head;
_Static_assert(sizeof(Head) == 88, "a record's head has no gaps");

/* One change: this and `size` bytes. */
typedef struct Change {
    uint64_t address, size;
} Change;

struct ShvJournal {
    ShvMemory *memory;
    char *path;
    int descriptor, file;
    uint64_t place, reserved, size, sequence;
    uint32_t previous;
    ShvJournalBadge badge;
};

static uint32_t checksum(const void *data, size_t size)
{
    return (uint32_t)crc32_z(crc32(0, NULL, 0), data, size);
}

static char *journal_path(ShvMemory *memory, const char *path)
{
    const size_t size = strlen(path) + sizeof ".journal";
    char *name = shv_allocate(memory, SHV_PART_RECORD, size, 1);
    if (name) shv_format(name, size, "%s.journal", path);
    return name;
}

static ShvStatus fail(ShvError *error, const char *what, const char *path, int number)
{
    char reason[128] = "unknown error";
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    return shv_fail(error, number == ENOMEM ? SHV_NO_MEMORY : SHV_FILE_ERROR, "cannot %s '%s': %s", what, path, reason);
}

/* ---- writing ---- */

static uint64_t new_identity(const char *path)
{
    struct timespec now = {0, 0};
    clock_gettime(CLOCK_REALTIME, &now);
    const int64_t numbers[] = {(int64_t)now.tv_sec, now.tv_nsec, getpid()};
    return shv_hash_text(shv_hash_bytes(SHV_HASH_START, numbers, sizeof numbers), path) | 1;
}

static int open_journal(ShvJournal *journal)
{
    journal->descriptor = open(journal->path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (journal->descriptor < 0) return errno;
    int number = shv_disk_reserve(journal->descriptor, &journal->reserved, 1);
    if (number == 0) number = shv_disk_write(journal->file, &journal->badge, sizeof journal->badge, journal->place);
    return number == 0 ? shv_disk_sync(journal->file) : number;
}

ShvStatus shv_journal_create(ShvJournal **journal, ShvMemory *memory, const char *path, int file, uint64_t place,
                             ShvError *error)
{
    *journal = NULL;
    ShvJournal *made = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a journal", sizeof *made);
    *made = (ShvJournal){.memory = memory, .descriptor = -1, .file = file, .place = place};
    made->badge.identity = new_identity(path);
    made->path = journal_path(memory, path);
    const int number = made->path ? open_journal(made) : ENOMEM;
    ShvStatus status =
        number == 0 ? shv_publish_sync_folder(path, error) : fail(error, "write the journal of", path, number);
    if (status == SHV_OK)
        *journal = made;
    else
        shv_journal_release(made);
    return status;
}

static int append(ShvJournal *journal, Kind kind, uint64_t from, uint64_t to, const void *changes, size_t size)
{
    int number;
    Head head = {.magic = MAGIC,
                 .identity = journal->badge.identity,
                 .place = journal->place,
                 .epoch = journal->badge.epoch,
                 .sequence = journal->sequence,
                 .kind = kind,
                 .from = from,
                 .to = to,
                 .size = size,
                 .changes = checksum(changes, size),
                 .previous = journal->previous};
    head.added = shv_disk_checksum(journal->file, from, to, &number);
    head.own = checksum(&head, offsetof(Head, own));
    const uint64_t end = journal->size + sizeof head + size;
    if (number == 0) number = shv_disk_reserve(journal->descriptor, &journal->reserved, end);
    if (number == 0) number = shv_disk_write(journal->descriptor, changes, size, journal->size + sizeof head);
    if (number == 0) number = shv_disk_write(journal->descriptor, &head, sizeof head, journal->size);
    if (number != 0) return number;
    journal->size = end;
    journal->sequence++;
    journal->previous = head.own;
    return 0;
}

int shv_journal_append(ShvJournal *journal, uint64_t from, uint64_t to, const void *changes, size_t size)
{
    return append(journal, KIND_FRAME, from, to, changes, size);
}

int64_t shv_journal_size(const ShvJournal *journal)
{
    return (int64_t)journal->size;
}

/* ---- carrying out ---- */

static int make_changes(int file, const unsigned char *at, size_t size)
{
    const unsigned char *end = at + size;
    while (at < end) {
        Change change;
        memcpy(&change, at, sizeof change);
        const int number = shv_disk_write(file, at + sizeof change, change.size, change.address);
        if (number != 0) return number;
        at += sizeof change + change.size;
    }
    return 0;
}

/* The records are known to be whole. */
static int carry_out(const ShvJournal *journal, const unsigned char *records)
{
    uint64_t at = 0;
    int number = 0;
    while (number == 0 && at < journal->size) {
        Head head;
        memcpy(&head, records + at, sizeof head);
        number = make_changes(journal->file, records + at + sizeof head, head.size);
        at += sizeof head + head.size;
    }
    return number;
}

static int settle(ShvJournal *journal, bool marked)
{
    int number = marked ? 0 : shv_disk_sync(journal->file);
    if (number == 0 && !marked) number = append(journal, KIND_MARK, 0, 0, NULL, 0);
    if (number == 0 && !marked) number = shv_disk_sync(journal->descriptor);
    unsigned char *records = number == 0 ? shv_allocate(journal->memory, SHV_PART_RECORD, journal->size, 1) : NULL;
    if (number == 0 && !records) number = ENOMEM;
    if (number == 0) number = shv_disk_read(journal->descriptor, records, journal->size, 0);
    if (number == 0) number = carry_out(journal, records);
    shv_release(records);
    const ShvJournalBadge next = {journal->badge.identity, journal->badge.epoch + 1};
    if (number == 0) number = shv_disk_write(journal->file, &next, sizeof next, journal->place);
    if (number == 0) number = shv_disk_sync(journal->file);
    if (number != 0) return number;
    journal->badge = next;
    journal->size = journal->previous = 0;
    return 0;
}

int shv_journal_settle(ShvJournal *journal)
{
    return journal->size > 0 ? settle(journal, false) : 0;
}

/* ---- the end ---- */

int shv_journal_finish(ShvJournal *journal)
{
    const ShvJournalBadge none = {0, 0};
    int number = shv_disk_write(journal->file, &none, sizeof none, journal->place);
    if (number == 0) number = shv_disk_sync(journal->file);
    if (number == 0 && unlink(journal->path) != 0 && errno != ENOENT) number = errno;
    return number;
}

void shv_journal_release(ShvJournal *journal)
{
    if (!journal) return;
    if (journal->descriptor >= 0) close(journal->descriptor);
    shv_release(journal->path);
    shv_release(journal);
}

/* ---- after a writer that is gone ---- */

/* Takes the head at `at` when it goes on from the records before and its changes are whole. */
static bool take_head(const ShvJournal *journal, const unsigned char *records, uint64_t size, uint64_t at, Head *head)
{
    if (size - at < sizeof *head) return false;
    memcpy(head, records + at, sizeof *head);
    if (head->magic != MAGIC || head->own != checksum(head, offsetof(Head, own))) return false;
    if (head->size > size - at - sizeof *head) return false;
    const bool first = at == 0;
    if (!first && (head->identity != journal->badge.identity || head->epoch != journal->badge.epoch ||
                   head->sequence != journal->sequence || head->previous != journal->previous))
        return false;
    return (!first || head->previous == 0) && head->changes == checksum(records + at + sizeof *head, head->size);
}

/* Sizes and places of the changes fit the record and the file: a checksum protects from damage, not from a forger. */
static bool changes_fit(const unsigned char *at, uint64_t size, uint64_t file_size)
{
    while (size >= sizeof(Change)) {
        Change change;
        memcpy(&change, at, sizeof change);
        size -= sizeof change;
        if (change.size > size || change.size > file_size || change.address > file_size - change.size) return false;
        at += sizeof change + change.size;
        size -= change.size;
    }
    return size == 0;
}

/* Follows the records to the last that counts; without a mark, that is before the first whose bytes in the file are not there.
   True: there is a mark. */
static bool follow(ShvJournal *journal, const unsigned char *records, uint64_t size, uint64_t file_size)
{
    uint64_t whole = 0, sequence = 0; /* as far as the file has proved to go along */
    uint32_t previous = 0;
    bool proved = true, marked = false;
    Head head;
    for (uint64_t at = 0; !marked && take_head(journal, records, size, at, &head); at += sizeof head + head.size) {
        if (at == 0) {
            journal->badge = (ShvJournalBadge){head.identity, head.epoch};
            journal->place = head.place;
        }
        if (!changes_fit(records + at + sizeof head, head.size, file_size)) break;
        journal->sequence = head.sequence + 1;
        journal->previous = head.own;
        marked = head.kind == KIND_MARK;
        int number = 0;
        proved = proved && head.to <= file_size &&
                 shv_disk_checksum(journal->file, head.from, head.to, &number) == head.added && number == 0;
        if (!proved && !marked) continue;
        whole = at + sizeof head + head.size;
        sequence = journal->sequence;
        previous = journal->previous;
    }
    journal->size = whole;
    journal->sequence = sequence;
    journal->previous = previous;
    return marked;
}

/* The end of the file by the last frame before the mark. */
static uint64_t end_of_frames(const unsigned char *records, uint64_t size)
{
    uint64_t end = 0;
    for (uint64_t at = 0; at < size;) {
        Head head;
        memcpy(&head, records + at, sizeof head);
        if (head.kind == KIND_FRAME) end = head.to;
        at += sizeof head + head.size;
    }
    return end;
}

static int recover(ShvJournal *journal, const unsigned char *records, uint64_t size)
{
    struct stat about;
    if (fstat(journal->file, &about) != 0) return errno;
    const bool marked = follow(journal, records, size, (uint64_t)about.st_size);
    if (journal->size == 0) { /* the writer ended before its first record */
        (void)unlink(journal->path);
        return 0;
    }
    ShvJournalBadge badge;
    int number = shv_disk_read(journal->file, &badge, sizeof badge, journal->place);
    if (number != 0) return number;
    /* Only the journal of this file, and only one that has not been carried out: twice does no harm where it has a mark. */
    const bool due = badge.epoch == journal->badge.epoch, again = badge.epoch == journal->badge.epoch + 1;
    if (badge.identity != journal->badge.identity || !(due || (again && marked))) return 0;
    const uint64_t end = end_of_frames(records, journal->size);
    number = settle(journal, marked);
    if (number == 0 && end > 0 && ftruncate(journal->file, (off_t)end) != 0) number = errno;
    return number == 0 ? shv_journal_finish(journal) : number;
}

bool shv_journal_exists(const char *path)
{
    char *name = journal_path(NULL, path);
    const bool there = name && access(name, F_OK) == 0;
    shv_release(name);
    return there;
}

static int recover_named(ShvJournal *journal)
{
    struct stat about;
    journal->descriptor = open(journal->path, O_RDWR | O_CLOEXEC);
    if (journal->descriptor < 0) return errno == ENOENT ? 0 : errno;
    if (fstat(journal->descriptor, &about) != 0) return errno;
    journal->reserved = (uint64_t)about.st_size;
    unsigned char *records = shv_allocate(journal->memory, SHV_PART_RECORD, (size_t)about.st_size, 1);
    if (!records) return ENOMEM;
    int number = shv_disk_read(journal->descriptor, records, (size_t)about.st_size, 0);
    if (number == 0) number = recover(journal, records, (uint64_t)about.st_size);
    shv_release(records);
    return number;
}

ShvStatus shv_journal_recover(const char *path, int file, ShvMemory *memory, ShvError *error)
{
    ShvJournal *journal = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *journal);
    if (!journal) return shv_fail_memory(error, "a journal", sizeof *journal);
    *journal = (ShvJournal){.memory = memory, .descriptor = -1, .file = file};
    journal->path = journal_path(memory, path);
    const int number = journal->path ? recover_named(journal) : ENOMEM;
    shv_journal_release(journal);
    return number == 0 ? SHV_OK : fail(error, "carry out the journal of", path, number);
}

/* ---- beside a writer ---- */

void shv_journal_lay(const unsigned char *changes, size_t size, uint64_t address, size_t length, void *buffer)
{
    for (size_t at = 0; at < size;) {
        Change change;
        memcpy(&change, changes + at, sizeof change);
        const unsigned char *bytes = changes + at + sizeof change;
        const uint64_t begin = change.address > address ? change.address : address;
        const uint64_t changed = change.address + change.size, wanted = address + length;
        const uint64_t end = changed < wanted ? changed : wanted;
        if (begin < end)
            memcpy((unsigned char *)buffer + (begin - address), bytes + (begin - change.address),
                   (size_t)(end - begin));
        at += sizeof change + change.size;
    }
}

/* The writer may be at it: records are taken as far as they are whole. Their changes move together. */
static void gather(ShvJournal *journal, uint64_t size, uint64_t file_size, ShvJournalView *view)
{
    Head head;
    for (uint64_t at = 0; !view->marked && take_head(journal, view->changes, size, at, &head);) {
        const unsigned char *changes = view->changes + at + sizeof head;
        if (!changes_fit(changes, head.size, file_size)) return;
        if (at == 0) journal->badge = (ShvJournalBadge){head.identity, head.epoch};
        journal->place = head.place;
        journal->sequence = head.sequence + 1;
        journal->previous = head.own;
        view->marked = head.kind == KIND_MARK;
        memmove(view->changes + view->size, changes, head.size);
        view->size += head.size;
        at += sizeof head + head.size;
    }
}

/* The badge is read after the records: those that the file says it has are dropped. */
static int look(ShvJournal *journal, ShvJournalView *view)
{
    struct stat records, file;
    journal->descriptor = open(journal->path, O_RDONLY | O_CLOEXEC);
    if (journal->descriptor < 0) return errno == ENOENT ? 0 : errno;
    if (fstat(journal->descriptor, &records) != 0) return errno;
    view->changes = shv_allocate(journal->memory, SHV_PART_RECORD, (size_t)records.st_size, 1);
    if (!view->changes) return ENOMEM;
    int number = shv_disk_read(journal->descriptor, view->changes, (size_t)records.st_size, 0);
    if (number == 0 && fstat(journal->file, &file) != 0) number = errno;
    if (number == 0) gather(journal, (uint64_t)records.st_size, (uint64_t)file.st_size, view);
    if (number == 0) number = shv_disk_read(journal->file, &view->badge, sizeof view->badge, journal->place);
    if (view->badge.identity != journal->badge.identity) view->badge = (ShvJournalBadge){0, 0};
    if (view->badge.identity == 0 || view->badge.epoch != journal->badge.epoch) {
        view->size = 0;
        view->marked = false;
    }
    return number;
}

int shv_journal_inspect(const char *path, int file, ShvMemory *memory, ShvJournalView *view)
{
    *view = (ShvJournalView){.size = 0};
    ShvJournal journal = {.memory = memory, .descriptor = -1, .file = file};
    journal.path = journal_path(memory, path);
    const int number = journal.path ? look(&journal, view) : ENOMEM;
    if (journal.descriptor >= 0) close(journal.descriptor);
    shv_release(journal.path);
    if (number == 0) return 0;
    shv_release(view->changes);
    view->changes = NULL;
    return number;
}
