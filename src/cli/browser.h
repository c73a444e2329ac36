/* A headless Chromium that shows a page and is asked for what its scripts give: the DevTools protocol over two pipes. */
#ifndef SHV_CLI_BROWSER_H
#define SHV_CLI_BROWSER_H

#include <sys/types.h>

#include "base/temporary.h"
#include "cli/command.h"

typedef struct ShvBrowser {
    const ShvTemporary *place;
    pid_t process;
    int to, from;              /* descriptors; −1: closed */
    char *answer;              /* the last one, terminated */
    size_t length, room, used; /* of what has been read; `used` bytes of it belong to the last answer */
    int asked;                 /* number of the last message */
    char session[64];          /* that the page is attached to */
} ShvBrowser;

/* Opens the page; `profile` is a folder in `place` for the browser's own files. SHV_UNSUPPORTED without Chromium: the message says
   what to install. On failure there is nothing to close. */
ShvStatus shv_browser_open(ShvBrowser *browser, const ShvTemporary *place, const char *page, const char *profile,
                           ShvError *error);
void shv_browser_close(ShvBrowser *browser);
/* What a script's expression (a promise is waited for) comes to, a text: valid until the next call. */
ShvStatus shv_browser_ask(ShvBrowser *browser, const char *expression, const char **text, ShvError *error);

#endif
