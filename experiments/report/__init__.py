"""The report: one HTML page from the stored results of `conelane compare`."""
