"""One probe of the library: look around in it, and read all that is known of it."""

from panokit.app import browsing
from panokit.app.browsing import Shelf
from panokit.app.desks import Desk
from panokit.app.progress import Progress
from panokit.app.widgets import badge, box, button, facts, fold, map_frame, scroll_to, words
from panokit.app.work import Work
from panokit.probes.probe import Probe


class ProbePage:
    """The part of Probe library that shows one probe, above the gallery's end."""

    def __init__(self, desk: Desk, work: Work, shelf: Shelf) -> None:
        self._desk, self._work, self._shelf = desk, work, shelf
        self._box = box()
        self._progress = Progress()

    def close(self) -> None:
        """Back to the gallery alone."""
        self._box.clear()

    async def open(self, id: str) -> None:
        """Show a probe."""
        library, work = self._shelf.library, self._work
        if library is None:
            return

        async def show() -> None:
            probe = await work.in_thread(browsing.probe_of, library, id)
            page = await work.in_process(browsing.probe_page, library, id)
            self._show(probe, page)

        scroll_to(self._box)
        await self._progress.run(show, "Reading the map")

    def _show(self, probe: Probe, page: bytes) -> None:
        address = self._desk.publish(page, "text/html; charset=utf-8", key="probe")
        self.close()
        with self._box, box("stage-step", "section"):
            with box("bar-row title-row"):
                words("h2", probe.name)
                button("Close", self.close, label=f"Close {probe.name}")
            with box("two"):
                with box("two-main"):
                    map_frame(address, f"{probe.name}: look around in it")
                with box("two-side"):
                    words("h3", "License")
                    facts(browsing.license_facts(probe))
                    words("h3", "What it is")
                    facts(browsing.probe_facts(probe))
                    steps = browsing.provenance_rows(probe)
                    if steps:
                        words("h3", "How it was made")
                        facts(steps)
            self._checks(probe)
        scroll_to(self._box)

    @staticmethod
    def _checks(probe: Probe) -> None:
        verdict = str(probe.report.verdict)
        with box("bar-row"):
            words("h3", "Quality")
            badge(f"QA {verdict}", verdict)
        for one in probe.report.failed:
            words("p", one.meaning or one.name, "notice fail")
        with fold("All checks"), box("table-scroll"), box("", "table"):
            with box("", "thead"), box("", "tr"):
                for heading in ("Check", "Figure", "Limit", "Verdict"):
                    words("th", heading)
            with box("", "tbody"):
                for name, figure, limit, judged in browsing.check_rows(probe):
                    with box("", "tr"):
                        words("th", name)
                        words("td", figure)
                        words("td", limit)
                        with box("", "td"):
                            if judged and limit:
                                badge(judged, judged)
