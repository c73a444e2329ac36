#include "cli/browser.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/programs.h"

/* A page of a gigabyte takes a browser that draws in software tens of seconds; a picture of it one. */
enum { PATIENCE = 120 * 1000, NAP = 50 * 1000 * 1000, NAPS = 2400 }; /* ms; ns, times */
/* Where the protocol wants its pipes in the browser. */
enum { COMMANDS = 3, ANSWERS = 4, FREE_DESCRIPTOR = 10 };

/* ---- programs ---- */

static int wait_for(pid_t child)
{
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    return status;
}

static const char *find_chromium(void)
{
    static const char *const names[] = {"chromium", "chromium-browser", "google-chrome"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (shv_on_path(names[i])) return names[i];
    return NULL;
}

/* ---- messages ---- */

static ShvStatus fail_browser(ShvError *error, const char *what)
{
    return shv_fail(error, SHV_FILE_ERROR, "the browser %s; `shiver view` writes the page for you to open yourself",
                    what);
}

static ShvStatus send_text(const ShvBrowser *browser, const char *text, ShvError *error)
{
    size_t left = strlen(text) + 1; /* the zero ends a message */
    while (left > 0) {
        const ssize_t written = write(browser->to, text, left);
        if (written < 0 && errno == EINTR) return shv_fail(error, SHV_INTERRUPTED, "interrupted");
        if (written <= 0) return fail_browser(error, "ended before it had drawn anything");
        text += written;
        left -= (size_t)written;
    }
    return SHV_OK;
}

/* More of what the browser says. */
static ShvStatus receive(ShvBrowser *browser, ShvError *error)
{
    if (browser->room - browser->length < 65536) {
        const size_t room = 2 * browser->room + 131072;
        char *grown = shv_reallocate(NULL, SHV_PART_GENERAL, browser->answer, room, 1);
        if (!grown) return shv_fail_memory(error, "a picture", room);
        browser->answer = grown;
        browser->room = room;
    }
    struct pollfd waited = {.fd = browser->from, .events = POLLIN};
    const int ready = poll(&waited, 1, PATIENCE);
    if (ready < 0) return shv_fail(error, SHV_INTERRUPTED, "interrupted");
    if (ready == 0) return fail_browser(error, "has said nothing for two minutes");
    const ssize_t count = read(browser->from, browser->answer + browser->length, browser->room - browser->length);
    if (count <= 0) return fail_browser(error, "ended before it had drawn anything");
    browser->length += (size_t)count;
    return SHV_OK;
}

/* Goes on to the next message; it is at the beginning of `answer`. */
static ShvStatus next_message(ShvBrowser *browser, ShvError *error)
{
    if (browser->length == 0) SHV_TRY(receive(browser, error)); /* the first of all: there is no room yet */
    memmove(browser->answer, browser->answer + browser->used, browser->length - browser->used);
    browser->length -= browser->used;
    browser->used = 0;
    size_t looked = 0;
    for (;;) {
        const char *end = memchr(browser->answer + looked, '\0', browser->length - looked);
        if (end) {
            browser->used = (size_t)(end - browser->answer) + 1;
            return SHV_OK;
        }
        looked = browser->length;
        SHV_TRY(receive(browser, error));
    }
}

/* Sends `method` with `parameters` (JSON members) and waits for its answer; what the browser tells unasked is passed over. */
static ShvStatus call(ShvBrowser *browser, const char *method, const char *parameters, ShvError *error)
{
    char begin[32], session[96] = "";
    const size_t size = strlen(method) + strlen(parameters) + 256;
    char *message = shv_allocate(NULL, SHV_PART_GENERAL, size, 1);
    if (!message) return shv_fail_memory(error, "a message", size);
    if (browser->session[0]) snprintf(session, sizeof session, ",\"sessionId\":\"%s\"", browser->session);
    const int length = snprintf(begin, sizeof begin, "{\"id\":%d,", ++browser->asked);
    snprintf(message, size, "%s\"method\":\"%s\",\"params\":{%s}%s}", begin, method, parameters, session);
    ShvStatus status = send_text(browser, message, error);
    shv_release(message);
    do {
        if (status == SHV_OK) status = next_message(browser, error);
    } while (status == SHV_OK && strncmp(browser->answer, begin, (size_t)length) != 0);
    return status;
}

/* The member `name`, a text without escapes, of the last answer, ended by a zero in place. NULL: there is none. */
static char *member(const ShvBrowser *browser, const char *name)
{
    char key[64];
    snprintf(key, sizeof key, "\"%s\":\"", name);
    char *found = strstr(browser->answer, key);
    if (!found) return NULL;
    found += strlen(key);
    found[strcspn(found, "\"")] = '\0';
    return found;
}

ShvStatus shv_browser_ask(ShvBrowser *browser, const char *expression, const char **text, ShvError *error)
{
    char parameters[1024];
    /* Expressions are ours and have neither quotes nor backslashes. */
    snprintf(parameters, sizeof parameters, "\"expression\":\"%s\",\"awaitPromise\":true,\"returnByValue\":true",
             expression);
    SHV_TRY(call(browser, "Runtime.evaluate", parameters, error));
    *text = member(browser, "value");
    return *text ? SHV_OK : fail_browser(error, "could not show the page");
}

/* ---- opening ---- */

/* In the child. */
static void become_browser(const ShvBrowser *browser, const char *program, const char *profile, int commands,
                           int answers)
{
    char folder[SHV_CLI_PATH + 32];
    shv_temporary_join(browser->place);
    snprintf(folder, sizeof folder, "--user-data-dir=%s", profile);
    const int silent = open("/dev/null", O_RDWR);
    dup2(silent, STDIN_FILENO);
    dup2(silent, STDOUT_FILENO);
    dup2(silent, STDERR_FILENO);
    /* Out of the way of the two places first. */
    const int in = fcntl(commands, F_DUPFD, FREE_DESCRIPTOR), out = fcntl(answers, F_DUPFD, FREE_DESCRIPTOR);
    dup2(in, COMMANDS);
    dup2(out, ANSWERS);
    close(in);
    close(out);
    /* Drawn in software: the same pixels on every machine. Chromium's sandbox does not work for root. */
    execlp(program, program, "--headless=new", "--remote-debugging-pipe", "--use-angle=swiftshader",
           "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--force-color-profile=srgb", "--hide-scrollbars",
           "--no-first-run", "--disable-extensions", "--disable-component-update", "--disable-background-networking",
           folder, geteuid() == 0 ? "--no-sandbox" : "--disable-sync", "about:blank", (char *)NULL);
    _exit(127);
}

static ShvStatus start(ShvBrowser *browser, const char *profile, ShvError *error)
{
    const char *program = find_chromium();
    int commands[2], answers[2];
    if (!program)
        return shv_fail(error, SHV_UNSUPPORTED,
                        "pictures are drawn by Chromium, which is not here: install Debian's package chromium");
    if (pipe(commands) != 0) return shv_fail(error, SHV_FILE_ERROR, "no pipe: %s", strerror(errno));
    if (pipe(answers) != 0) {
        close(commands[0]);
        close(commands[1]);
        return shv_fail(error, SHV_FILE_ERROR, "no pipe: %s", strerror(errno));
    }
    browser->to = commands[1];
    browser->from = answers[0];
    fcntl(browser->to, F_SETFD, FD_CLOEXEC);
    fcntl(browser->from, F_SETFD, FD_CLOEXEC);
    signal(SIGPIPE, SIG_IGN);
    browser->process = fork();
    if (browser->process == 0) become_browser(browser, program, profile, commands[0], answers[1]);
    close(commands[0]);
    close(answers[1]);
    return browser->process > 0 ? SHV_OK : shv_fail(error, SHV_FILE_ERROR, "no process: %s", strerror(errno));
}

/* What a name of a file means in an address: all but letters, digits and a few signs as %XX. */
static void put_address(char *address, size_t size, const char *path)
{
    size_t length = (size_t)snprintf(address, size, "\"url\":\"file://");
    for (; *path && length + 8 < size; path++) {
        const unsigned char c = (unsigned char)*path;
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           (c != '\0' && strchr("/._-", c));
        length += (size_t)snprintf(address + length, size - length, plain ? "%c" : "%%%02X", c);
    }
    snprintf(address + length, size - length, "\"");
}

static ShvStatus attach(ShvBrowser *browser, const char *page, ShvError *error)
{
    char parameters[3 * SHV_CLI_PATH + 64];
    put_address(parameters, sizeof parameters, page);
    SHV_TRY(call(browser, "Target.createTarget", parameters, error));
    const char *target = member(browser, "targetId");
    if (!target) return fail_browser(error, "could not open the page");
    snprintf(parameters, sizeof parameters, "\"targetId\":\"%.64s\",\"flatten\":true", target);
    SHV_TRY(call(browser, "Target.attachToTarget", parameters, error));
    const char *session = member(browser, "sessionId");
    if (!session) return fail_browser(error, "could not open the page");
    snprintf(browser->session, sizeof browser->session, "%s", session);
    return SHV_OK;
}

/* The page's scripts run some time after the browser has been told of it. */
static ShvStatus wait_for_page(ShvBrowser *browser, ShvError *error)
{
    const struct timespec nap = {0, NAP};
    for (int i = 0; i < NAPS; i++) {
        const char *text = NULL;
        SHV_TRY(shv_browser_ask(browser, "window.shiver ? shiver.then(() => `ready`, () => `failed`) : `wait`", &text,
                                error));
        if (strcmp(text, "ready") == 0) return SHV_OK;
        if (strcmp(text, "failed") == 0) return fail_browser(error, "could not show the run");
        nanosleep(&nap, NULL);
    }
    return fail_browser(error, "has not shown the page for two minutes");
}

ShvStatus shv_browser_open(ShvBrowser *browser, const ShvTemporary *place, const char *page, const char *profile,
                           ShvError *error)
{
    *browser = (ShvBrowser){.place = place, .process = -1, .to = -1, .from = -1};
    ShvStatus status = start(browser, profile, error);
    if (status == SHV_OK) status = attach(browser, page, error);
    if (status == SHV_OK) status = wait_for_page(browser, error);
    if (status != SHV_OK) shv_browser_close(browser);
    return status;
}

void shv_browser_close(ShvBrowser *browser)
{
    if (browser->to >= 0) close(browser->to);
    if (browser->from >= 0) close(browser->from);
    /* It ends when its pipe does; should it not, it is ended. */
    if (browser->process > 0) {
        kill(browser->process, SIGTERM);
        wait_for(browser->process);
        shv_temporary_end(browser->place,
                          browser->process); /* its helpers write into the profile's folder until they end */
    }
    shv_release(browser->answer);
    *browser = (ShvBrowser){.process = -1, .to = -1, .from = -1};
}
