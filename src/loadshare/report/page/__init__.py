"""A page of cases and their results: one HTML file that needs nothing else."""

from loadshare.report.page.chapter import Chapter, chapter, chapter_of_file
from loadshare.report.page.report import report_page, save_report, write_report

__all__ = [
    "Chapter",
    "chapter",
    "chapter_of_file",
    "report_page",
    "save_report",
    "write_report",
]
